// SPDX-License-Identifier: Apache-2.0
// How a camera moves from frame to frame.
#pragma once

#include <optional>

#include "geometry/rigid3.h"
#include "optim/pose_prior.h"
#include "tracking/tracker_options.h"

namespace rds {

// Constant velocity in the frame of the camera, averaged over the last steps as each of them is as noisy as two poses;
// and what it is worth. A value; no thread safety of its own.
class MotionModel {
 public:
  explicit MotionModel(const MotionOptions& options) : options_(options) {}

  // The camera moved so within so many seconds (not above 0: nothing is learnt).
  void Observe(const Rigid3& now_from_before, double seconds);
  void Forget() { velocity_.reset(); }
  // The motion to be expected within so many seconds; none if nothing was observed.
  [[nodiscard]] std::optional<Rigid3> Predict(double seconds) const;
  // Of points at rest in the frame of the camera, m/s and rad/s; 0 if nothing was observed.
  [[nodiscard]] Tangent6 Velocity() const { return velocity_.value_or(Tangent6::Zero()); }
  // How far a pose may be from its prediction over so many seconds; nothing where the options want no prior.
  [[nodiscard]] std::optional<PosePrior> Prior(const Rigid3& predicted_camera_from_world, double seconds) const;

 private:
  MotionOptions options_;
  std::optional<Tangent6> velocity_;  // (meters, radians) a second
};

}  // namespace rds
