// SPDX-License-Identifier: Apache-2.0
// The normal equations of bundle adjustment.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/rigid3.h"
#include "optim/block_system.h"
#include "optim/bundle_adjustment.h"

namespace rds {

// State of a bundle adjustment and its linearization. Points are eliminated: each touches few poses, so what remains is
// a small system over the poses (Schur complement; Triggs et al., "Bundle adjustment: a modern synthesis", 1999,
// section 6.1). Observations of weight 0, behind the camera or not finite never take part. Not thread-safe; keeps
// references to what the constructor is given.
class BundleEquations {
 public:
  // Indices in the problem are in range.
  BundleEquations(const BundleProblem& problem, const BundleOptions& options);

  // Whether no observation takes part.
  [[nodiscard]] bool empty() const { return terms_.empty(); }
  // Half the sum of squares, or of Huber's kernel. Infinite if a point that takes part is behind a camera.
  [[nodiscard]] double Cost(bool robust) const;
  // Forms the normal equations at the present state.
  void Linearize(bool robust);
  // Solves them with the diagonal raised by `damping` times itself. Returns by how much the step should lower the cost;
  // negative if there is no step.
  double FindStep(double damping);
  void TakeStep();
  // Returns to where the last TakeStep started.
  void Revert();
  // Takes observations with a chi2 above the 95 % quantile out, for good.
  void DropOutliers();
  // chi2 of any observation of the problem, as ReprojectionChi2.
  [[nodiscard]] double Chi2(const BundleProblem::Observation& observation) const;

  [[nodiscard]] std::vector<Rigid3> Poses() const;  // camera_from_world, of the problem's poses
  [[nodiscard]] const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  struct Camera {
    Rigid3 from_world;
    Eigen::Matrix3d rotation;

    explicit Camera(const Rigid3& camera_from_world)
        : from_world(camera_from_world), rotation(camera_from_world.RotationMatrix()) {}
  };

  // An observation that takes part.
  struct Term {
    PixelObservation keypoint;
    std::uint32_t pose = 0;
    std::uint32_t link = kNone;  // of its point and its pose, if the pose is free
    double scale2 = 0;           // weight^2 * inverse_sigma2; 0 = an outlier now
    double huber = 0;
  };

  // A point and a free pose that see each other: a block of the normal matrix off its diagonal.
  struct Link {
    std::uint32_t slot = 0;                // of the pose among the free ones
    Eigen::Matrix<double, 6, 3> block;     // pose by point
    Eigen::Matrix<double, 6, 3> whitened;  // block * L^-T, where L L^T is the point's damped diagonal block
  };

  // A point that takes part, with its part of the normal equations.
  struct Landmark {
    std::uint32_t point = 0;
    std::uint32_t first_term = 0;  // its terms and links end where the next landmark's begin
    std::uint32_t first_link = 0;
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inverse_root = Eigen::Matrix3d::Zero();  // L^-1
    Eigen::Vector3d whitened = Eigen::Vector3d::Zero();      // L^-1 gradient
  };

  struct FreePose {
    std::uint32_t pose = 0;
    Eigen::Matrix<double, 6, 6> hessian;
    Eigen::Matrix<double, 6, 1> gradient;
  };

  void CollectTerms();
  void AssignSlots();
  void CollectLinks();
  void LinearizeTerm(const Term& term, bool robust, Landmark* landmark);
  void EliminatePoints(double damping, Eigen::VectorXd* right);

  const BundleProblem& problem_;
  const BundleOptions& options_;
  std::vector<Camera> cameras_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Term> terms_;          // by point
  std::vector<Landmark> landmarks_;  // by point; one more at the end marks the end of the last one's terms and links
  std::vector<Link> links_;          // by point, then by slot
  std::vector<FreePose> free_;       // by slot
  std::vector<std::uint32_t> slot_;  // of each pose; kNone = fixed or unseen
  BlockSystem system_{0};
  Eigen::VectorXd pose_step_;
  std::vector<Eigen::Vector3d> point_step_;  // one for each landmark
  std::vector<Camera> cameras_before_;
  std::vector<Eigen::Vector3d> points_before_;
};

}  // namespace rds
