// SPDX-License-Identifier: Apache-2.0
#include "geometry/alignment.h"

#include <Eigen/SVD>

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
  const Eigen::Vector3d from_mean = from.rowwise().mean();
  const Eigen::Vector3d to_mean = to.rowwise().mean();
  from.colwise() -= from_mean;
  to.colwise() -= to_mean;
  const double n = static_cast<double>(count);
  const Eigen::Matrix3d covariance = to * from.transpose() / n;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) {
    sign.z() = -1;
  }
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double variance = from.squaredNorm() / n;
  Alignment result;
  if (with_scale && variance > 0) {
    result.scale = svd.singularValues().dot(sign) / variance;
  }
  result.target_from_source.rotation = Eigen::Quaterniond(rotation).normalized();
  result.target_from_source.translation = to_mean - result.scale * (rotation * from_mean);
  return result;
}

}  // namespace rds
