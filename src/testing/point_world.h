// SPDX-License-Identifier: Apache-2.0
// A world of points without images, for tests of tracking.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "base/random.h"
#include "map/local_map.h"
#include "testing/view.h"

namespace rds {

// Random points 2 to 4 m in front of the origin, each with a look of its own. TestCamera sees those in front of it that
// fall into its image.
class PointWorld {
 public:
  explicit PointWorld(std::uint32_t count, std::uint64_t seed = 11) {
    Random random(seed);
    for (std::uint32_t i = 0; i < count; ++i) {
      positions_.emplace_back(random.Uniform(-1.2, 1.2), random.Uniform(-0.9, 0.9), random.Uniform(2, 4));
      looks_.push_back({random.Bits(), random.Bits(), random.Bits(), random.Bits()});
    }
  }

  // What a camera sees of the points `first` up to `last`; and which point each keypoint shows.
  struct View {
    std::shared_ptr<const FrameData> data;
    std::vector<std::uint32_t> points;
  };
  [[nodiscard]] View Look(const Rigid3& camera_from_world, std::uint32_t first, std::uint32_t last) const {
    View view;
    std::vector<Keypoint> keypoints;
    std::vector<Descriptor> descriptors;
    for (std::uint32_t i = first; i < last; ++i) {
      const Eigen::Vector3d in_camera = camera_from_world * positions_[i];
      if (in_camera.z() < 0.3) {
        continue;
      }
      const Keypoint keypoint = See(camera_from_world, positions_[i]);
      if (keypoint.x >= 0 && keypoint.x < 640 && keypoint.y >= 0 && keypoint.y < 480) {
        keypoints.push_back(keypoint);
        descriptors.push_back(looks_[i]);
        view.points.push_back(i);
      }
    }
    view.data = std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors));
    return view;
  }
  [[nodiscard]] View Look(const Rigid3& camera_from_world) const {
    return Look(camera_from_world, 0, static_cast<std::uint32_t>(positions_.size()));
  }

  // Adds a keyframe that sees the points of a view; points that the map does not have are made.
  KeyframeId AddTo(Map& map, FrameId frame, const Rigid3& camera_from_world, const View& view) {
    const KeyframeId id = map.AddKeyframe(frame, 0.1 * frame.value, camera_from_world, view.data);
    ids_.resize(positions_.size());
    for (std::uint32_t i = 0; i < view.points.size(); ++i) {
      PointId& known = ids_[view.points[i]];
      if (known.valid()) {
        map.Observe(known, id, i);
        map.UpdateAppearance(known);
      } else {
        known = map.AddPoint(positions_[view.points[i]], id, i);
      }
    }
    map.UpdateCovisibility(id);
    return id;
  }

  // Moves points after the map has seen them.
  void Move(std::uint32_t first, std::uint32_t last, const Eigen::Vector3d& by) {
    for (std::uint32_t i = first; i < last; ++i) {
      positions_[i] += by;
    }
  }
  [[nodiscard]] PointId IdOf(std::uint32_t point) const { return ids_[point]; }

 private:
  std::vector<Eigen::Vector3d> positions_;
  std::vector<Descriptor> looks_;
  std::vector<PointId> ids_;  // in the map
};

}  // namespace rds
