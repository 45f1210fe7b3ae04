// SPDX-License-Identifier: Apache-2.0
// What a solver found, and what it was computed from: the only way by which algorithms that solve outside the lock
// change the map.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "geometry/rigid3.h"

namespace rds {

// A keyframe as a solver saw it. The map has moved on if the revision of its pose is another one by now.
struct KeyframeVersion {
  KeyframeId keyframe;
  std::uint32_t revision = 0;  // Keyframe::pose_revision
};

// A value, made by a solver and given to Map::Apply. Everything in it names the versions it was computed from; Apply
// leaves out what has changed or gone since.
struct Correction {
  struct Pose {
    KeyframeVersion of;
    Rigid3 camera_from_world;
    bool points_follow = false;  // the points that this keyframe made move with it
  };
  struct Point {
    PointId point;
    std::uint32_t revision = 0;  // MapPoint::revision
    KeyframeVersion reference;   // MapPoint::reference
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
  };
  // That a keyframe does not see a point after all.
  struct Removal {
    PointId point;
    KeyframeId keyframe;
  };
  // A new point that two keyframes see.
  struct NewPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    KeyframeVersion first;
    std::uint32_t first_keypoint = 0;
    KeyframeVersion second;
    std::uint32_t second_keypoint = 0;
  };
  // That a keypoint shows a point: an observation, or, where the keypoint shows another point, a fusion of both.
  struct Match {
    PointId point;
    KeyframeVersion in;
    std::uint32_t keypoint = 0;
  };

  std::vector<Pose> poses;
  std::vector<Point> points;
  std::vector<Removal> removals;
  std::vector<NewPoint> new_points;
  std::vector<Match> matches;
};

// What Map::Apply did.
struct Applied {
  int poses = 0;
  int points = 0;
  std::vector<PointId> new_points;
};

}  // namespace rds
