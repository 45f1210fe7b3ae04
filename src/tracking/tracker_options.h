// SPDX-License-Identifier: Apache-2.0
// Options of tracking.
#pragma once

#include <cstdint>

namespace rds {

// When points of unknown state are used.
enum class UnknownPoints : std::uint8_t {
  kPaper,     // only while fewer than tau static ones are there
  kAlways,    // always, with the weight 1 - p that lets static ones lead
  kDeferred,  // after the pose, where static ones are few, but only those that agree with it; all of them if static
              // ones are too few for a pose
};

// Which matches a pose may stand on: the paper's Algorithm 2.
struct AssociationOptions {
  bool use_semantics = true;  // false: every match is used, as if no point had a label
  int tau = 20;               // static matches that are enough
  UnknownPoints unknown = UnknownPoints::kDeferred;
  int min_static_inliers = 60;  // kDeferred: with fewer static inliers unknown ones are let in
  int min_static_matches = 10;  // kDeferred: with fewer static matches all unknown ones are used
  int min_observations = 4;     // with semantics, a point with fewer observations has proportionally less weight
};

// A camera in a hand or on a robot: its velocity stays, but for accelerations of this size (standard deviation for
// each axis). Second differences of the poses of one hand-held recording at 30 Hz, their noise included: 4.7 m/s^2 and
// 3.9 rad/s^2.
struct MotionOptions {
  double acceleration_m_s2 = 4.5;  // 0 = a pose stands on its matches alone
  double angular_acceleration_rad_s2 = 9;
};

// When a frame becomes a keyframe: ORB-SLAM3's rule, which the paper has, too.
struct KeyframePolicyOptions {
  int max_frames = 30;          // a keyframe at the latest after so many frames
  int min_frames = 6;           // none sooner than so many frames after the last, unless the view changes fast
  double tracked_ratio = 0.95;  // of the reference keyframe's points: below this the view is new
  double shared_ratio = 0.65;   // of what it shared with the view before: below this, mapping may be busy
  int depth_tracked = 100;      // fewer keypoints with depth tracked than this ...
  int depth_untracked = 70;     // ... while more than this could be: a keyframe is wanted
  int min_inliers = 15;
  int semantic_frames = 8;  // with semantics: a keyframe for an idle segmenter, at most so often; 0 = never
};

struct TrackerOptions {
  int min_start_points = 100;    // keypoints with depth that a first keyframe needs
  double motion_window_px = 15;  // at most, by what the prediction is worth; doubled if too little is found
  int min_motion_matches = 20;
  int min_motion_inliers = 10;
  double reference_ratio = 0.7;
  int min_reference_matches = 15;
  double local_window_px = 3;
  double recovery_window_px = 10;
  double local_ratio = 0.8;
  int min_inliers = 30;           // of a tracked frame; static ones alone need only tau
  int min_recovery_inliers = 50;  // on recovery; static ones alone need only min_inliers
  int recovery_keyframes = 10;    // nearest keyframes that are tried
  AssociationOptions association;
  MotionOptions motion;
  KeyframePolicyOptions policy;
};

}  // namespace rds
