// SPDX-License-Identifier: Apache-2.0
// What goes into the system and what comes out for each frame.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "base/ids.h"
#include "base/image.h"
#include "geometry/rigid3.h"

namespace rds {

// One registered RGB-D frame. Images are shared, never copied or changed.
struct RgbdFrame {
  double timestamp_s = 0;                // strictly increasing from frame to frame
  std::shared_ptr<const Image8> image;   // BGR or gray, 8 bit
  std::shared_ptr<const Image16> depth;  // of the same size; units of PinholeCamera::depth_scale
};

enum class TrackingState : std::uint8_t { kNotInitialized, kTracked, kLost };

// "not_initialized", "tracked", "lost".
[[nodiscard]] std::string_view ToString(TrackingState state);

// Class of a keypoint after tracking; colors of the paper's figures 12, 13, 15.
enum class FeatureState : std::uint8_t {
  kUnmatched,
  kStatic,    // matched to a static point and used (blue)
  kUnknown,   // matched to a point of unknown state (green)
  kRejected,  // matched to a dynamic point or thrown out as an outlier (red)
};

struct FeatureView {
  float x = 0;  // pixel in the recorded image
  float y = 0;
  FeatureState state = FeatureState::kUnmatched;
};

// Wall time of the parts of Process, milliseconds.
struct FrameTiming {
  double total_ms = 0;
  double extraction_ms = 0;
  double matching_ms = 0;   // motion model or reference keyframe: search
  double pose_ms = 0;       // pose optimizations
  double local_map_ms = 0;  // projecting and searching the local map
  double cpu_ms = 0;        // CPU time of the calling thread
};

// Outcome of one frame.
struct FrameResult {
  FrameId frame;
  double timestamp_s = 0;
  TrackingState state = TrackingState::kNotInitialized;
  std::optional<Rigid3> world_from_camera;     // present if and only if tracked; jumps where the map is corrected
  std::optional<Rigid3> odometry_from_camera;  // the same but for jumps: the motion between tracked frames, added up
  WorldId world;  // of the map, valid if tracked: poses of different worlds have nothing to do with each other
  std::uint32_t epoch = 0;  // of the map: poses of one world in one epoch go together
  bool is_keyframe = false;
  int static_matches = 0;    // used for the pose
  int unknown_matches = 0;   // used for the pose
  int rejected_matches = 0;  // dynamic, or outliers of the pose optimization
  // Share of the depth image (with labels: of what they call static) that the pose explains, 0 to 1, by the view of the
  // oldest keyframe around that looks the same way: near 1 where all that is asked is static and the pose right; low
  // where much has moved, or where the pose follows what moves. Absent where too little can be told.
  std::optional<double> confidence;
  std::optional<int> semantic_delay_frames;  // d of the paper's equation 1; absent before the first label
  int keyframes_in_map = 0;
  int points_in_map = 0;
  FrameTiming timing;
  std::vector<FeatureView> features;  // only where SystemOptions::keep_features asks for them
};

}  // namespace rds
