#include "optim/bundle_adjustment.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <memory>

#include "base/error.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

constexpr double kInitialRadius = 1e4;
constexpr double kFunctionTolerance = 1e-5;
constexpr int kMaxDensePoses = 60;  // above this the reduced camera system is factorised as a sparse matrix

// Residual of an observation from a free pose; parameters: the pose's increment, the point.
template <int Rows>
class FreePoseCost final : public ceres::SizedCostFunction<Rows, 6, 3> {
 public:
  FreePoseCost(const PinholeCamera& camera, const PoseVariable& pose, const ReprojectionTarget& target)
      : camera_(camera), pose_(pose), target_(target) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    EvaluateReprojection<Rows>(camera_, pose_, target_, parameters[1], residuals,
                               jacobians != nullptr ? jacobians[0] : nullptr,
                               jacobians != nullptr ? jacobians[1] : nullptr);
    return true;
  }

 private:
  const PinholeCamera& camera_;
  const PoseVariable& pose_;
  const ReprojectionTarget& target_;
};

// Residual of an observation from a fixed pose; parameter: the point.
template <int Rows>
class FixedPoseCost final : public ceres::SizedCostFunction<Rows, 3> {
 public:
  FixedPoseCost(const PinholeCamera& camera, const PoseVariable& pose, const ReprojectionTarget& target)
      : camera_(camera), pose_(pose), target_(target) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    EvaluateReprojection<Rows>(camera_, pose_, target_, parameters[0], residuals, nullptr,
                               jacobians != nullptr ? jacobians[0] : nullptr);
    return true;
  }

 private:
  const PinholeCamera& camera_;
  const PoseVariable& pose_;
  const ReprojectionTarget& target_;
};

// Huber's loss, which can be switched off.
class SwitchedHuber final : public ceres::LossFunction {
 public:
  explicit SwitchedHuber(double threshold) : threshold_(threshold) {}
  void Evaluate(double squared, double out[3]) const override {
    if (!enabled || squared <= threshold_ * threshold_) {
      out[0] = squared;
      out[1] = 1;
      out[2] = 0;
      return;
    }
    const double norm = std::sqrt(squared);
    out[0] = threshold_ * (2 * norm - threshold_);
    out[1] = threshold_ / norm;
    out[2] = 0;  // plain reweighting
  }
  bool enabled = true;

 private:
  double threshold_;
};

class PoseUpdater final : public ceres::EvaluationCallback {
 public:
  explicit PoseUpdater(std::vector<PoseVariable>* poses) : poses_(poses) {}
  void PrepareForEvaluation(bool /*evaluate_jacobians*/, bool new_evaluation_point) override {
    if (new_evaluation_point) {
      for (PoseVariable& pose : *poses_) {
        pose.Update();
      }
    }
  }

 private:
  std::vector<PoseVariable>* poses_;
};

class Watch final : public ceres::IterationCallback {
 public:
  explicit Watch(const std::function<bool()>& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    iterations += summary.iteration > 0 ? 1 : 0;
    steps += summary.iteration > 0 && summary.step_is_successful ? 1 : 0;
    stopped = stopped || (stop_ && stop_());
    return stopped ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  int iterations = 0;  // over all stages
  int steps = 0;       // of them, those that lowered the cost
  bool stopped = false;

 private:
  const std::function<bool()>& stop_;
};

ceres::Problem::Options ProblemOptions(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = callback;
  return options;
}

// The problem in Ceres' terms. Lives for one call of AdjustBundle; Ceres keeps pointers into it.
class Adjuster {
 public:
  Adjuster(const BundleProblem& problem, const BundleOptions& options, const std::function<bool()>& stop);
  BundleResult Run();

 private:
  void AddObservations();
  // Squared residual without weight, in standard deviations; infinite behind the camera or where not finite.
  [[nodiscard]] double SquaredError(const BundleProblem::Observation& observation) const;
  [[nodiscard]] std::vector<std::uint8_t> FindOutliers() const;
  // Runs Ceres from the present state. False, and the state is as before, if it failed.
  bool Solve(int iterations, ceres::Solver::Summary* summary);

  const BundleProblem& problem_;
  const BundleOptions& options_;
  Watch watch_;
  std::vector<PoseVariable> poses_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<ReprojectionTarget> targets_;  // one for each observation
  std::deque<FreePoseCost<2>> free_mono_;
  std::deque<FreePoseCost<3>> free_depth_;
  std::deque<FixedPoseCost<2>> fixed_mono_;
  std::deque<FixedPoseCost<3>> fixed_depth_;
  SwitchedHuber huber_mono_;
  SwitchedHuber huber_depth_;
  PoseUpdater updater_;
  ceres::Problem ceres_;
  ceres::ParameterBlockOrdering ordering_;  // group 0: points, eliminated first; group 1: poses
  int free_poses_ = 0;
};

Adjuster::Adjuster(const BundleProblem& problem, const BundleOptions& options, const std::function<bool()>& stop)
    : problem_(problem),
      options_(options),
      watch_(stop),
      points_(problem.points),
      targets_(problem.observations.size()),
      huber_mono_(options.huber_mono),
      huber_depth_(options.huber_depth),
      updater_(&poses_),
      ceres_(ProblemOptions(&updater_)) {
  poses_.reserve(problem.poses.size());
  for (const BundleProblem::Pose& pose : problem.poses) {
    poses_.emplace_back(pose.camera_from_world);
    fixed_.push_back(pose.fixed ? 1 : 0);
  }
  if (!fixed_.empty() && std::find(fixed_.begin(), fixed_.end(), 1) == fixed_.end()) {
    fixed_.front() = 1;  // else nothing would tell where the world is
  }
}

void Adjuster::AddObservations() {
  std::vector<std::uint8_t> pose_added(poses_.size());
  std::vector<std::uint8_t> point_added(points_.size());
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const BundleProblem::Observation& observation = problem_.observations[i];
    if (!(observation.keypoint.weight > 0) || !std::isfinite(SquaredError(observation))) {
      continue;
    }
    targets_[i] = ReprojectionTarget(observation.keypoint);
    PoseVariable& pose = poses_[observation.pose];
    double* increment = pose.increment.data();
    double* point = points_[observation.point].data();
    const bool has_depth = observation.keypoint.HasDepth();
    ceres::LossFunction* loss = has_depth ? &huber_depth_ : &huber_mono_;
    const auto create = [&](auto* costs) { return &costs->emplace_back(problem_.camera, pose, targets_[i]); };
    if (fixed_[observation.pose] != 0) {
      if (has_depth) {
        ceres_.AddResidualBlock(create(&fixed_depth_), loss, point);
      } else {
        ceres_.AddResidualBlock(create(&fixed_mono_), loss, point);
      }
    } else {
      if (has_depth) {
        ceres_.AddResidualBlock(create(&free_depth_), loss, increment, point);
      } else {
        ceres_.AddResidualBlock(create(&free_mono_), loss, increment, point);
      }
      if (pose_added[observation.pose] == 0) {
        pose_added[observation.pose] = 1;
        ordering_.AddElementToGroup(increment, 1);
        ++free_poses_;
      }
    }
    if (point_added[observation.point] == 0) {
      point_added[observation.point] = 1;
      ordering_.AddElementToGroup(point, 0);
    }
  }
}

double Adjuster::SquaredError(const BundleProblem::Observation& observation) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const PixelObservation& keypoint = observation.keypoint;
  const PoseVariable& pose = poses_[observation.pose];
  const Eigen::Vector3d in_camera = pose.rotation * points_[observation.point] + pose.translation;
  if (!(in_camera.z() > kMinReprojectionDepth_m)) {
    return kInfinity;
  }
  const Eigen::Vector2d projected = problem_.camera.Project(in_camera);
  double squared_px = (keypoint.pixel - projected).squaredNorm();
  if (keypoint.HasDepth()) {
    const double error = keypoint.right_x - (projected.x() - problem_.camera.Bf() / in_camera.z());
    squared_px += error * error;
  }
  const double squared = squared_px * keypoint.inverse_sigma2;
  return std::isfinite(squared) ? squared : kInfinity;
}

std::vector<std::uint8_t> Adjuster::FindOutliers() const {
  std::vector<std::uint8_t> outlier;
  outlier.reserve(problem_.observations.size());
  for (const BundleProblem::Observation& observation : problem_.observations) {
    outlier.push_back(SquaredError(observation) > (observation.keypoint.HasDepth() ? kChi2Depth : kChi2Mono) ? 1 : 0);
  }
  return outlier;
}

bool Adjuster::Solve(int iterations, ceres::Solver::Summary* summary) {
  ceres::Solver::Options options;
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.jacobi_scaling = false;  // the damping scales by the diagonal already
  options.initial_trust_region_radius = kInitialRadius;
  options.function_tolerance = kFunctionTolerance;
  options.linear_solver_type = free_poses_ == 0               ? ceres::SPARSE_NORMAL_CHOLESKY
                               : free_poses_ > kMaxDensePoses ? ceres::SPARSE_SCHUR
                                                              : ceres::DENSE_SCHUR;
  if (free_poses_ > 0) {
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>(ordering_);
  }
  options.callbacks.push_back(&watch_);

  const std::vector<PoseVariable> poses_before = poses_;
  const std::vector<Eigen::Vector3d> points_before = points_;
  ceres::Solve(options, &ceres_, summary);
  const bool usable = summary->IsSolutionUsable();
  if (!usable) {
    poses_ = poses_before;
    points_ = points_before;
  }
  for (PoseVariable& pose : poses_) {
    pose.Update();
  }
  return usable;
}

BundleResult Adjuster::Run() {
  BundleResult result;
  AddObservations();
  ceres::Solver::Summary summary;
  if (ceres_.NumResidualBlocks() > 0 && Solve(options_.robust_iterations, &summary)) {
    result.initial_cost = summary.initial_cost;
    result.final_cost = summary.final_cost;
    if (!watch_.stopped && options_.final_iterations > 0) {
      const std::vector<std::uint8_t> outlier = FindOutliers();
      for (std::size_t i = 0; i < targets_.size(); ++i) {
        targets_[i].scale = outlier[i] != 0 ? 0 : targets_[i].scale;
      }
      huber_mono_.enabled = false;
      huber_depth_.enabled = false;
      if (Solve(options_.final_iterations, &summary)) {
        result.final_cost = summary.final_cost;
      }
    }
    result.usable = watch_.steps > 0 || !watch_.stopped;
  }
  result.iterations = watch_.iterations;
  result.outlier = FindOutliers();
  result.points = points_;
  result.poses.reserve(poses_.size());
  for (const PoseVariable& pose : poses_) {
    result.poses.push_back(pose.Value());
  }
  return result;
}

}  // namespace

BundleResult AdjustBundle(const BundleProblem& problem, const BundleOptions& options,
                          const std::function<bool()>& stop) {
  for (const BundleProblem::Observation& observation : problem.observations) {
    Check(observation.pose < problem.poses.size(), "bundle adjustment: index of a pose out of range");
    Check(observation.point < problem.points.size(), "bundle adjustment: index of a point out of range");
  }
  return Adjuster(problem, options, stop).Run();
}

}  // namespace rds
