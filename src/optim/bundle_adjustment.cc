// SPDX-License-Identifier: Apache-2.0
#include "optim/bundle_adjustment.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "optim/bundle_equations.h"
#include "optim/reprojection.h"

namespace rds {
namespace {

constexpr double kFirstDamping = 1e-5;  // relative to the diagonal of the normal matrix
constexpr double kMinDamping = 1e-9;
constexpr double kMaxDamping = 1e6;
constexpr double kTinyDecrease = 1e-5;  // of the cost, relative: a stage has converged
constexpr double kNoDecrease = 1e-8;    // the same for the decrease that a step promises

enum class Outcome { kConverged, kOutOfIterations, kStuck, kStopped };

// One stage of Levenberg-Marquardt.
struct Stage {
  Outcome outcome = Outcome::kOutOfIterations;
  int iterations = 0;
  int steps = 0;  // iterations that lowered the cost
  double cost = 0;
};

Stage Minimize(BundleEquations* equations, bool robust, int iterations, const std::function<bool()>& stop) {
  Stage stage;
  stage.cost = equations->Cost(robust);
  double damping = kFirstDamping;
  bool is_linear = false;  // the equations are those of the present state
  while (damping <= kMaxDamping) {
    if (stop && stop()) {
      stage.outcome = Outcome::kStopped;
      return stage;
    }
    if (stage.iterations >= iterations) {
      stage.outcome = Outcome::kOutOfIterations;
      return stage;
    }
    if (!is_linear) {
      equations->Linearize(robust);
      is_linear = true;
    }
    ++stage.iterations;
    const double expected = equations->FindStep(damping);
    if (expected >= 0 && expected <= kNoDecrease * stage.cost) {
      stage.outcome = Outcome::kConverged;
      return stage;
    }
    if (expected > 0) {
      equations->TakeStep();
      const double cost = equations->Cost(robust);
      if (cost < stage.cost) {
        ++stage.steps;
        const bool is_tiny = stage.cost - cost <= kTinyDecrease * stage.cost;
        stage.cost = cost;
        if (is_tiny) {
          stage.outcome = Outcome::kConverged;
          return stage;
        }
        is_linear = false;
        damping = std::max(0.1 * damping, kMinDamping);
        continue;
      }
      equations->Revert();
    }
    damping = std::max(10 * damping, 1e-3);
  }
  stage.outcome = Outcome::kStuck;
  return stage;
}

}  // namespace

BundleResult AdjustBundle(const BundleProblem& problem, const BundleOptions& options,
                          const std::function<bool()>& stop) {
  for (const BundleProblem::Observation& observation : problem.observations) {
    Check(observation.pose < problem.poses.size(), "bundle adjustment: index of a pose out of range");
    Check(observation.point < problem.points.size(), "bundle adjustment: index of a point out of range");
  }
  BundleResult result;
  BundleEquations equations(problem, options);
  if (!equations.empty()) {
    result.initial_cost = equations.Cost(true);
    const Stage robust = Minimize(&equations, true, options.robust_iterations, stop);
    result.iterations = robust.iterations;
    result.final_cost = robust.cost;
    result.usable = robust.steps > 0 || robust.outcome == Outcome::kConverged;
    if (robust.outcome != Outcome::kStopped && options.final_iterations > 0) {
      equations.DropOutliers();
      const Stage final = Minimize(&equations, false, options.final_iterations, stop);
      result.iterations += final.iterations;
      result.final_cost = final.cost;
      result.usable = result.usable || final.steps > 0 || final.outcome == Outcome::kConverged;
    }
  }
  result.poses = equations.Poses();
  result.points = equations.points();
  result.outlier.reserve(problem.observations.size());
  for (const BundleProblem::Observation& observation : problem.observations) {
    result.outlier.push_back(IsInlier(observation.keypoint, equations.Chi2(observation)) ? 0 : 1);
  }
  return result;
}

}  // namespace rds
