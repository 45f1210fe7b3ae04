// SPDX-License-Identifier: Apache-2.0
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"

namespace rds {

Alignment Align(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target, bool with_scale) {
  if (source.size() != target.size() || source.size() < 3) {
    throw InputError("alignment needs two point sets of the same size, at least 3 points each");
  }
  const auto count = static_cast<Eigen::Index>(source.size());
  Eigen::Matrix3Xd from(3, count);
  Eigen::Matrix3Xd to(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    from.col(i) = source[static_cast<std::size_t>(i)];
    to.col(i) = target[static_cast<std::size_t>(i)];
  }
  // A single place, seen many times, has no scale.
  const bool scalable = (from.colwise() - from.col(0)).squaredNorm() > 0;
  const Eigen::Matrix4d target_from_source = Eigen::umeyama(from, to, with_scale && scalable);
  Alignment result;
  const Eigen::Matrix3d linear = target_from_source.topLeftCorner<3, 3>();
  result.scale = with_scale && scalable ? std::cbrt(linear.determinant()) : 1;
  result.target_from_source.rotation = Eigen::Quaterniond(Eigen::Matrix3d(linear / result.scale)).normalized();
  result.target_from_source.translation = target_from_source.topRightCorner<3, 1>();
  return result;
}

}  // namespace rds
