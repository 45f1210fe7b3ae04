// SPDX-License-Identifier: Apache-2.0
// An exact dynamic RGB-D world: a textured room, people in it, a moving camera; color, depth, masks, ground truth.
#pragma once

#include <memory>

#include "synth/synthetic_options.h"
#include "system/frame.h"

namespace rds {

// One rendered frame with its truth.
struct SyntheticFrame {
  RgbdFrame rgbd;                      // BGR; depth in units of camera.depth_scale, 0 = none
  std::shared_ptr<const Image8> mask;  // 255 where a mover is seen by the pixel's depth or by any part of its color
  Rigid3 world_from_camera;            // world: z up, origin on the floor in the middle of the room, meters
};

// Renders frames of a seeded scene. Room and camera path depend on seed and path only, so the same options with movers
// = 0 give the same pictures without people. Same options, same bytes, whatever the order of calls. Building takes
// about half a second, a frame about 80 ms at 640 x 480. Const methods may be called from several threads at once.
class SyntheticWorld {
 public:
  // Throws InputError for options out of range.
  explicit SyntheticWorld(const SyntheticOptions& options);
  ~SyntheticWorld();
  SyntheticWorld(SyntheticWorld&&) noexcept;

  [[nodiscard]] const SyntheticOptions& options() const;
  [[nodiscard]] const PinholeCamera& camera() const { return options().camera; }
  [[nodiscard]] int frame_count() const { return options().frames; }

  // `index` in [0, frame_count()), else InvariantError.
  [[nodiscard]] SyntheticFrame Render(int index) const;
  [[nodiscard]] double TimestampS(int index) const;
  [[nodiscard]] Rigid3 WorldFromCamera(int index) const;

  // Distance of the camera's center from the nearest piece of room or furniture (static), and from the nearest body
  // part of a mover (infinite without movers), in meters; for checks.
  // Static: of a room, not of the building.
  [[nodiscard]] double StaticClearanceM(int index) const;
  [[nodiscard]] double MoverClearanceM(int index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rds
