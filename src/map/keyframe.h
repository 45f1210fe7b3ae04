// SPDX-License-Identifier: Apache-2.0
// A keyframe of the map.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"
#include "geometry/rigid3.h"

namespace rds {

// What the mask of a keyframe says of a keypoint.
enum class KeypointLabel : std::uint8_t { kNone, kStatic, kDynamic };

// An edge of the covisibility graph: the number of points that both keyframes see.
struct Covisible {
  KeyframeId keyframe;
  int shared_points = 0;
};

// A frame kept in the map: pose, features, the points they see, its edges in the covisibility graph and the spanning
// tree. Owned and changed by Map only; not thread-safe by itself.
struct Keyframe {
  KeyframeId id;
  WorldId world;
  FrameId frame;
  double timestamp_s = 0;
  Rigid3 camera_from_world;         // in the frame of its world
  std::uint32_t pose_revision = 0;  // grows with each change of the pose; lets a solver see that its copy is old
  std::shared_ptr<const FrameData> data;
  std::vector<PointId> points;        // one for each keypoint, invalid = none
  std::vector<KeypointLabel> labels;  // one for each keypoint once the keyframe is labeled, empty before
  bool certain = false;               // the dynamic ones were seen to move
  std::vector<Covisible> covisible;   // most shared points first, ties by id
  KeyframeId parent;                  // spanning tree of its world; invalid for the root
  std::vector<KeyframeId> children;   // ascending

  [[nodiscard]] bool IsLabeled() const { return !labels.empty(); }
  [[nodiscard]] Eigen::Vector3d CameraCenter() const {
    return -(camera_from_world.rotation.conjugate() * camera_from_world.translation);
  }
};

}  // namespace rds
