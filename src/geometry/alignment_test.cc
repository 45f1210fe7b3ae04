// SPDX-License-Identifier: Apache-2.0
#include "geometry/alignment.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/error.h"
#include "base/random.h"

namespace rds {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Standard deviations along the axes, before an arbitrary rotation.
Points Cloud(std::size_t count, const Eigen::Vector3d& extent, std::uint64_t seed) {
  Random random(seed);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point(random.Gaussian(0, 1), random.Gaussian(0, 1), random.Gaussian(0, 1));
    points.push_back(ExpSo3({0.5, 0.2, -0.7}) * point.cwiseProduct(extent) + Eigen::Vector3d(5, -2, 1));
  }
  return points;
}

Points Transformed(const Points& points, const Alignment& alignment) {
  Points result;
  for (const Eigen::Vector3d& point : points) {
    result.push_back(alignment.Apply(point));
  }
  return result;
}

double Cost(const Points& source, const Points& target, const Alignment& alignment) {
  double cost = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    cost += (alignment.Apply(source[i]) - target[i]).squaredNorm();
  }
  return cost;
}

const Alignment kSimilarity{1.7, {ExpSo3({1.2, -2.0, 0.6}), {3, -4, 0.5}}};

void ExpectNear(const Alignment& a, const Alignment& b, double tolerance) {
  EXPECT_NEAR(a.scale, b.scale, tolerance);
  EXPECT_LT((a.target_from_source.translation - b.target_from_source.translation).norm(), tolerance);
  EXPECT_LT(AngleOf(a.target_from_source.rotation * b.target_from_source.rotation.conjugate()), tolerance);
}

TEST(Align, RecoversASimilarity) {
  const Points source = Cloud(30, {1, 2, 0.5}, 1);
  ExpectNear(Align(source, Transformed(source, kSimilarity), true), kSimilarity, 1e-10);
}

TEST(Align, RecoversARigidTransform) {
  const Alignment rigid{1, kSimilarity.target_from_source};
  const Points source = Cloud(30, {1, 2, 0.5}, 2);
  ExpectNear(Align(source, Transformed(source, rigid), false), rigid, 1e-10);
}

TEST(Align, KeepsScaleOneUnlessAsked) {
  const Points source = Cloud(30, {1, 2, 0.5}, 3);
  const Alignment result = Align(source, Transformed(source, kSimilarity), false);
  EXPECT_EQ(result.scale, 1);
  EXPECT_LT(AngleOf(result.target_from_source.rotation * kSimilarity.target_from_source.rotation.conjugate()), 1e-10);
}

TEST(Align, DoesNotReflectPlanarSets) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Points source = Cloud(10, {1, 2, 0}, seed);
    const Alignment result = Align(source, Transformed(source, kSimilarity), true);
    EXPECT_GT(result.target_from_source.RotationMatrix().determinant(), 0.5);
    ExpectNear(result, kSimilarity, 1e-9);
  }
}

TEST(Align, ThreePointsAreEnough) {
  const Points source = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  ExpectNear(Align(source, Transformed(source, kSimilarity), true), kSimilarity, 1e-10);
}

TEST(Align, FindsTheBestRotationOfAReflectedSet) {
  const Points source = Cloud(40, {1, 2, 0.1}, 5);
  Points target = source;
  for (Eigen::Vector3d& point : target) {
    point.z() *= -1;
  }
  const Alignment result = Align(source, target, true);
  EXPECT_NEAR(result.target_from_source.RotationMatrix().determinant(), 1, 1e-12);
  EXPECT_GT(result.scale, 0);
  const double best = Cost(source, target, result);
  for (int axis = 0; axis < 3; ++axis) {  // a minimum: any small turn is worse, even with the best translation
    for (const double angle : {-0.02, 0.02}) {
      Alignment turned = result;
      turned.target_from_source.rotation =
          ExpSo3(angle * Eigen::Vector3d::Unit(axis)) * result.target_from_source.rotation;
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < source.size(); ++i) {
        shift += (target[i] - turned.Apply(source[i])) / static_cast<double>(source.size());
      }
      turned.target_from_source.translation += shift;
      EXPECT_GT(Cost(source, target, turned), best);
    }
  }
}

TEST(Align, IsTheLeastSquaresSolutionUnderNoise) {
  const Points source = Cloud(200, {1, 2, 0.5}, 6);
  Points target = Transformed(source, kSimilarity);
  Random random(7);
  for (Eigen::Vector3d& point : target) {
    point += 0.05 * Eigen::Vector3d(random.Gaussian(0, 1), random.Gaussian(0, 1), random.Gaussian(0, 1));
  }
  const Alignment result = Align(source, target, true);
  ExpectNear(result, kSimilarity, 0.05);
  EXPECT_LT(Cost(source, target, result), Cost(source, target, kSimilarity));
  for (const double factor : {0.999, 1.001}) {
    Alignment scaled = result;
    scaled.scale *= factor;
    scaled.target_from_source.translation +=
        result.scale * (1 - factor) * (result.target_from_source.rotation * Eigen::Vector3d(5, -2, 1));
    EXPECT_GT(Cost(source, target, scaled), Cost(source, target, result));
  }
}

TEST(Align, CoincidentPointsStayFinite) {
  const Points source(5, Eigen::Vector3d(1, 2, 3));
  const Points target(5, Eigen::Vector3d(0, 1, 0));
  const Alignment result = Align(source, target, true);
  EXPECT_LT((result.Apply(source[0]) - target[0]).norm(), 1e-12);
}

TEST(Align, RejectsTooFewOrUnequal) {
  const Points two = {{0, 0, 0}, {1, 0, 0}};
  const Points three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(Align(two, two, false), InputError);
  EXPECT_THROW(Align(three, two, false), InputError);
}

}  // namespace
}  // namespace rds
