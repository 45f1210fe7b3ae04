// SPDX-License-Identifier: Apache-2.0
// Maps of a round corridor without images, with the drift that is asked for: for tests of what spans a whole map.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/random.h"
#include "map/map.h"
#include "testing/view.h"

namespace rds {

struct RingOptions {
  std::uint64_t seed = 1;
  double radius_m = 8;       // of the path
  int keyframes = 160;       // on the way
  double rounds = 1.1;       // that the way takes
  int landmarks_per_m = 80;  // of the path
  double drift = 0;          // scale error of each relative motion: 0.01 = 1 %
  double turn_rad = 0;       // added to each relative motion, about the vertical axis
  double noise_px = 0.7;     // of keypoints
  double flips = 0.03;       // share of the bits of a descriptor that differ from one view to the next
  int variety = 0;           // bits in which a look differs from one that all are like; 0 = looks are their own
  int period = 0;            // looks repeat so many times round the ring; 0 = they never do
};

// A corridor round a circle: walls, floor and ceiling with landmarks, along which a camera looks ahead. What it sees
// again after losing sight of it becomes new points: as if tracking had never known the place.
class RingWorld {
 public:
  explicit RingWorld(const RingOptions& options)
      : options_(options), cells_(std::max(360, static_cast<int>(45 * options.radius_m))) {
    Random random(options.seed);
    const double round_m = 2 * std::numbers::pi * options.radius_m;
    const int count = static_cast<int>(round_m * options.landmarks_per_m);
    for (int i = 0; i < count; ++i) {
      const double angle = random.Uniform(0, 2 * std::numbers::pi);
      const int side = static_cast<int>(random.Index(4));
      const double across = random.Uniform(-kHalf_m, kHalf_m);
      const double radius = options.radius_m + (side == 0 ? -Wall(angle) : side == 1 ? Wall(angle + 1) : across);
      const double height = side == 2 ? -kHalf_m : side == 3 ? kHalf_m : random.Uniform(-kHalf_m, kHalf_m);
      landmarks_.push_back({radius * std::sin(angle), height, radius * std::cos(angle)});
      looks_.push_back(options.variety > 0 ? Flipped({}, options.variety, random)
                                           : Descriptor{random.Bits(), random.Bits(), random.Bits(), random.Bits()});
      by_cell_[CellOf(angle)].push_back(static_cast<std::uint32_t>(i));
    }
    if (options.period > 0) {
      Repeat(options.period);
    }
    for (int i = 0; i < options.keyframes; ++i) {
      truth.push_back(PoseAt(2 * std::numbers::pi * options.rounds * i / options.keyframes));
    }
  }

  // camera_from_world on the path, looking along it.
  [[nodiscard]] Rigid3 PoseAt(double angle) const {
    const Rigid3 world_from_camera{ExpSo3({0, angle + std::numbers::pi / 2, 0}),
                                   {options_.radius_m * std::sin(angle), 0, options_.radius_m * std::cos(angle)}};
    return world_from_camera.Inverse();
  }

  // What a camera sees, with noise; and which landmark each keypoint shows.
  struct View {
    std::shared_ptr<const FrameData> data;
    std::vector<std::uint32_t> landmarks;
  };
  [[nodiscard]] View Look(const Rigid3& camera_from_world, std::uint64_t seed) const {
    Random random(seed);
    View view;
    std::vector<Keypoint> keypoints;
    std::vector<Descriptor> descriptors;
    const Eigen::Vector3d center = camera_from_world.Inverse().translation;
    const int here = CellOf(std::atan2(center.x(), center.z()));
    for (int cell = here - kReach; cell <= here + kReach; ++cell) {
      const auto found = by_cell_.find((cell + cells_) % cells_);
      for (const std::uint32_t i : found != by_cell_.end() ? found->second : std::vector<std::uint32_t>{}) {
        const Eigen::Vector3d in_camera = camera_from_world * landmarks_[i];
        if (in_camera.z() < 0.5 || in_camera.z() > 5) {
          continue;
        }
        Keypoint keypoint = See(camera_from_world, landmarks_[i]);
        keypoint.x += static_cast<float>(random.Gaussian(0, options_.noise_px));
        keypoint.y += static_cast<float>(random.Gaussian(0, options_.noise_px));
        if (keypoint.x < 0 || keypoint.x >= 640 || keypoint.y < 0 || keypoint.y >= 480) {
          continue;
        }
        keypoint.raw_x = keypoint.x;
        keypoint.raw_y = keypoint.y;
        keypoint.depth_m += static_cast<float>(random.Gaussian(0, static_cast<double>(keypoint.depth_sigma_m)));
        keypoints.push_back(keypoint);
        descriptors.push_back(Flipped(looks_[i], static_cast<int>(options_.flips * 256), random));
        view.landmarks.push_back(i);
      }
    }
    view.data = std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors),
                                                  Surfaces(camera_from_world));
    return view;
  }

  // Adds the keyframes `first` up to `last` of the way to a map, as tracking with drift would; the first one starts a
  // world.
  std::vector<KeyframeId> AddTo(Map& map, int first, int last, std::uint64_t noise_seed = 7) {
    std::vector<KeyframeId> ids;
    std::unordered_map<std::uint32_t, std::pair<PointId, int>> known;  // by landmark: its point, and when seen last
    const WorldId world = map.AddWorld();
    Rigid3 pose;
    for (int i = first; i < last; ++i) {
      if (i > first) {
        Rigid3 motion = truth[static_cast<std::size_t>(i)] * truth[static_cast<std::size_t>(i) - 1].Inverse();
        motion.translation *= 1 + options_.drift;
        motion.rotation = ExpSo3({0, options_.turn_rad, 0}) * motion.rotation;
        pose = motion * pose;
      }
      const View view = Look(truth[static_cast<std::size_t>(i)], noise_seed * 100'000 + static_cast<std::uint64_t>(i));
      const KeyframeId id = map.AddKeyframe(FrameId{frame_}, frame_ / 10.0, pose, view.data, world);
      ++frame_;
      for (std::uint32_t k = 0; k < view.landmarks.size(); ++k) {
        auto& [point, seen] = known[view.landmarks[k]];
        if (point.valid() && map.Find(point) != nullptr && i - seen <= 2) {
          map.Observe(point, id, k);
        } else {
          point = map.AddPoint(pose.Inverse() * view.data->keypoints()[k].PointIn(TestCamera()), id, k);
        }
        seen = i;
      }
      for (const std::uint32_t landmark : view.landmarks) {
        map.UpdateAppearance(known[landmark].first);
      }
      map.UpdateCovisibility(id);
      ids.push_back(id);
      truth_of_[id] = truth[static_cast<std::size_t>(i)];
    }
    return ids;
  }

  // Root mean square error of the positions of keyframes (of one world), the first of which is held at the truth.
  [[nodiscard]] double Rmse(const Map& map, const std::vector<KeyframeId>& ids) const {
    const Rigid3 truth_from_map = truth_of_.at(ids.front()).Inverse() * map.CameraFromWorld(ids.front());
    double sum = 0;
    for (const KeyframeId id : ids) {
      sum += (truth_from_map * map.CameraFromWorld(id).Inverse().translation - truth_of_.at(id).Inverse().translation)
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(ids.size()));
  }
  // How far the pose of one keyframe relative to another is from the truth.
  [[nodiscard]] double RelativeError(const Map& map, KeyframeId a, KeyframeId b) const {
    const Rigid3 estimated = map.CameraFromWorld(a) * map.CameraFromWorld(b).Inverse();
    const Rigid3 actual = truth_of_.at(a) * truth_of_.at(b).Inverse();
    return (estimated.translation - actual.translation).norm();
  }

  std::vector<Rigid3> truth;  // camera_from_world, of the keyframes on the way

 private:
  static constexpr double kHalf_m = 1.2;
  static constexpr int kReach = 60;  // cells, of 14 cm at most

  // Half the width of the corridor: pillars and niches, so that each place has a shape of its own.
  static double Wall(double angle) {
    return kHalf_m + 0.25 * std::sin(9 * angle) + 0.15 * std::sin(23 * angle + 2) + 0.1 * std::sin(41 * angle + 1);
  }
  [[nodiscard]] int CellOf(double angle) const {
    const double turns = angle / (2 * std::numbers::pi);
    return static_cast<int>((turns - std::floor(turns)) * cells_) % cells_;
  }
  // Landmarks look like those of the first part of the ring, and lie where those do.
  void Repeat(int times) {
    const double part = 2 * std::numbers::pi / times;
    std::vector<Eigen::Vector3d> landmarks;
    std::vector<Descriptor> looks;
    for (std::size_t i = 0; i < landmarks_.size(); ++i) {
      double angle = std::atan2(landmarks_[i].x(), landmarks_[i].z());
      angle += angle < 0 ? 2 * std::numbers::pi : 0;
      for (int k = 0; angle < part && k < times; ++k) {
        landmarks.push_back(ExpSo3({0, k * part, 0}) * landmarks_[i]);
        looks.push_back(looks_[i]);
      }
    }
    landmarks_ = std::move(landmarks);
    looks_ = std::move(looks);
    by_cell_.clear();
    for (std::uint32_t i = 0; i < landmarks_.size(); ++i) {
      by_cell_[CellOf(std::atan2(landmarks_[i].x(), landmarks_[i].z()))].push_back(i);
    }
    period_ = times;
  }
  [[nodiscard]] static Descriptor Flipped(Descriptor look, int flips, Random& random) {
    for (int i = 0; i < flips; ++i) {
      const std::uint32_t bit = random.Index(256);
      look[bit >> 6U] ^= std::uint64_t{1} << (bit & 63U);
    }
    return look;
  }
  // The depth grid of a level camera: a column sees a wall at one depth, by steps along its ray.
  [[nodiscard]] DepthGrid Surfaces(const Rigid3& camera_from_world) const {
    constexpr int kColumns = 640 / kDepthGridStep;
    constexpr int kRows = 480 / kDepthGridStep;
    const Rigid3 world_from_camera = camera_from_world.Inverse();
    const PinholeCamera camera = TestCamera();
    const auto is_wall = [&](const Eigen::Vector3d& point) {
      double angle = std::atan2(point.x(), point.z());
      if (period_ > 0) {
        const double part = 2 * std::numbers::pi / period_;
        angle -= part * std::floor(angle / part);
      }
      const double across = std::hypot(point.x(), point.z()) - options_.radius_m;
      return across <= -Wall(angle) || across >= Wall(angle + 1);
    };
    std::vector<double> wall_m(kColumns, 0);
    for (int column = 0; column < kColumns; ++column) {
      const Eigen::Vector2d pixel(DepthGrid::MiddlePixel(column), camera.cy);
      for (double z = 0.3; z < 6 && wall_m[static_cast<std::size_t>(column)] == 0; z += 0.02) {
        wall_m[static_cast<std::size_t>(column)] = is_wall(world_from_camera * camera.Unproject(pixel, z)) ? z : 0;
      }
    }
    std::vector<float> depth_m;
    for (int row = 0; row < kRows; ++row) {
      const double slope = std::abs(DepthGrid::MiddlePixel(row) - camera.cy) / camera.fy;
      const double level_m = slope > 0 ? kHalf_m / slope : 6;
      for (const double wall : wall_m) {
        const double depth = wall > 0 ? std::min(wall, level_m) : level_m;
        depth_m.push_back(depth < 6 ? static_cast<float>(depth) : 0.0F);
      }
    }
    return {kColumns, kRows, std::move(depth_m)};
  }

  RingOptions options_;
  int cells_;  // along the ring
  int period_ = 0;
  std::vector<Eigen::Vector3d> landmarks_;
  std::vector<Descriptor> looks_;
  std::unordered_map<int, std::vector<std::uint32_t>> by_cell_;
  std::unordered_map<KeyframeId, Rigid3> truth_of_;
  std::uint32_t frame_ = 0;
};

}  // namespace rds
