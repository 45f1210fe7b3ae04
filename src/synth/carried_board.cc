// SPDX-License-Identifier: Apache-2.0
#include "synth/carried_board.h"

#include <cmath>
#include <numbers>

#include "synth/paint.h"

namespace rds::synthetic {
namespace {

constexpr double kWidth_m = 0.7;
constexpr double kHeight_m = 0.5;
constexpr double kDistance_m = 1.1;
constexpr double kSwing_m = 0.3;  // to each side ...
constexpr double kSwing_s = 7;    // ... and back

}  // namespace

CarriedBoard::CarriedBoard(std::uint64_t seed) {
  Random random(seed);
  Canvas canvas(kWidth_m, kHeight_m, 0.0015);
  PaintPoster(canvas, random);
  texture_ = std::make_shared<Texture>(canvas);
}

Quad CarriedBoard::At(const CameraPath& camera, double time_s) const {
  const Rigid3 world_from_camera = camera.WorldFromCamera(time_s);
  const double phase = 2 * std::numbers::pi * time_s / kSwing_s;
  const double turn = 0.2 * std::sin(1.3 * phase);
  const Eigen::Vector3d right(std::cos(turn), 0, std::sin(turn));
  const Eigen::Vector3d center(kSwing_m * std::sin(phase), 0.08 * std::cos(2 * phase), kDistance_m);
  Quad quad;
  quad.right = world_from_camera.rotation * right;
  quad.down = world_from_camera.rotation * Eigen::Vector3d::UnitY();
  quad.width = kWidth_m;
  quad.height = kHeight_m;
  quad.corner = world_from_camera * center - 0.5 * (kWidth_m * quad.right + kHeight_m * quad.down);
  quad.texture = texture_;
  quad.is_mover = true;
  return quad;
}

}  // namespace rds::synthetic
