// SPDX-License-Identifier: Apache-2.0
#include "synth/synthetic_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/random.h"
#include "synth/building.h"
#include "synth/camera_path.h"
#include "synth/carried_board.h"
#include "synth/depth_sensor.h"
#include "synth/mover.h"
#include "synth/rasterizer.h"
#include "synth/room.h"
#include "synth/walk_planner.h"

namespace rds {

struct SyntheticWorld::Impl {
  explicit Impl(const SyntheticOptions& options_)
      : options(options_), room(BuildStage(options_)), path(options_.path, options_.seed), movers(PlanPeople()) {
    if (options.scenario == SyntheticScenario::kCarried) {
      board.emplace(options.seed);
    }
  }

  static synthetic::Room BuildStage(const SyntheticOptions& options) {
    const double texel_scale = std::clamp(640.0 / options.camera.width, 1.0, 2.5);
    return options.scenario == SyntheticScenario::kBuilding
               ? synthetic::BuildBuilding(options.seed, {options.alike, options.decor}, texel_scale)
               : synthetic::BuildRoom(options.seed, texel_scale);
  }
  [[nodiscard]] std::vector<synthetic::Mover> PlanPeople() const {
    const double duration_s = (options.frames - 1) / kSyntheticFrameRateHz;
    return options.scenario == SyntheticScenario::kBuilding
               ? synthetic::PlanRingWalkers(ResolveMovers(options), duration_s, options.seed)
               : synthetic::PlanMovers(options.scenario, ResolveMovers(options), room, path, duration_s, options.seed);
  }

  SyntheticOptions options;
  synthetic::Room room;
  synthetic::CameraPath path;
  std::vector<synthetic::Mover> movers;
  std::optional<synthetic::CarriedBoard> board;
};

SyntheticWorld::SyntheticWorld(const SyntheticOptions& options) {
  Validate(options);
  impl_ = std::make_unique<Impl>(options);
}

SyntheticWorld::~SyntheticWorld() = default;
SyntheticWorld::SyntheticWorld(SyntheticWorld&&) noexcept = default;

const SyntheticOptions& SyntheticWorld::options() const { return impl_->options; }

double SyntheticWorld::TimestampS(int index) const {
  Check(index >= 0 && index < frame_count(), "frame of a synthetic world out of range");
  return index / kSyntheticFrameRateHz;
}

Rigid3 SyntheticWorld::WorldFromCamera(int index) const { return impl_->path.WorldFromCamera(TimestampS(index)); }

SyntheticFrame SyntheticWorld::Render(int index) const {
  const double time_s = TimestampS(index);
  const PinholeCamera& camera = impl_->options.camera;
  SyntheticFrame frame;
  frame.world_from_camera = WorldFromCamera(index);
  synthetic::Scene scene = impl_->room.scene;
  for (const synthetic::Mover& mover : impl_->movers) {
    std::vector<synthetic::Capsule> body = mover.At(time_s);
    scene.capsules.insert(scene.capsules.end(), std::make_move_iterator(body.begin()),
                          std::make_move_iterator(body.end()));
  }
  if (impl_->board) {
    scene.quads.push_back(impl_->board->At(impl_->path, time_s));
  }
  synthetic::Drawing drawing = synthetic::Draw(scene, camera, frame.world_from_camera.Inverse());
  const bool noise = impl_->options.noise;
  const std::uint64_t seed = (impl_->options.seed * 0x9E3779B97F4A7C15ULL) ^ (static_cast<std::uint64_t>(index) << 20);
  if (impl_->options.depth_error > 0) {
    const auto factor = static_cast<float>(Random(~seed).Gaussian(1, impl_->options.depth_error));
    for (float& depth_m : drawing.depth_m) {
      depth_m *= factor;
    }
  }
  frame.rgbd.timestamp_s = time_s;
  frame.rgbd.image = std::make_shared<const Image8>(
      synthetic::MeasureColor(drawing.color, camera, noise ? synthetic::kColorSigma : 0.0, seed));
  frame.rgbd.depth = std::make_shared<const Image16>(noise ? synthetic::MeasureDepth(drawing.depth_m, camera, {}, seed)
                                                           : synthetic::QuantizeDepth(drawing.depth_m, camera));
  frame.mask = std::make_shared<const Image8>(std::move(drawing.mask));
  return frame;
}

double SyntheticWorld::StaticClearanceM(int index) const {
  return impl_->room.Clearance(WorldFromCamera(index).translation);
}

double SyntheticWorld::MoverClearanceM(int index) const {
  const Eigen::Vector3d camera = WorldFromCamera(index).translation;
  double clearance = std::numeric_limits<double>::infinity();
  for (const synthetic::Mover& mover : impl_->movers) {
    for (const synthetic::Capsule& part : mover.At(TimestampS(index))) {
      clearance = std::min(clearance, synthetic::Distance(part, camera));
    }
  }
  return clearance;
}

}  // namespace rds
