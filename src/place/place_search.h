// SPDX-License-Identifier: Apache-2.0
// Where in the map a frame was taken, whatever came before it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "map/local_map.h"
#include "optim/optim_options.h"
#include "place/explained_share.h"
#include "place/place_index.h"

namespace rds {

// A frame whose place is asked for.
struct PlaceQuery {
  std::shared_ptr<const FrameData> data;
  std::vector<KeypointLabel> labels;  // one for each keypoint; empty: it has no label (yet)

  // Those of keypoints that are not known as dynamic.
  [[nodiscard]] std::vector<Descriptor> Descriptors() const;
};

// What a keyframe is indexed by: its keypoints that show points, without what is dynamic.
[[nodiscard]] std::vector<Descriptor> IndexedDescriptors(const Map& map, KeyframeId keyframe);

// The keyframes that look most like a query, best first: by their own score and those of the keyframes that see most of
// the same points, one only of those that are alike in that. `is_wanted` says which may be named.
[[nodiscard]] std::vector<KeyframeId> ProposePlaces(const Map& map, std::span<const PlaceScore> scores,
                                                    std::size_t most,
                                                    const std::function<bool(const Keyframe&)>& is_wanted);

// The surroundings of a keyframe, to hold a query against. A copy.
struct PlaceCandidate {
  struct View {
    std::shared_ptr<const FrameData> data;
    Rigid3 camera_from_world;
    std::vector<KeypointLabel> labels;  // as in Keyframe
  };
  KeyframeId keyframe;
  WorldId world;
  Rigid3 keyframe_from_world;
  std::shared_ptr<const LocalMap> map;
  std::vector<std::uint8_t> left_out;  // one for each point of the map: no match is made with it
  std::vector<std::uint32_t> points;   // of the map: those that it and its best covisible keyframes see
  std::vector<View> views;             // itself and the best covisible ones
};

// Left out are what is dynamic and the points in `known`, ascending: those that the query sees anyway say nothing of
// whether its place is known by others. Nothing if the keyframe is gone.
[[nodiscard]] std::optional<PlaceCandidate> PlanPlace(const Map& map, KeyframeId keyframe,
                                                      std::span<const PointId> known = {});

// A pose that a query may have.
struct PlaceFound {
  KeyframeId keyframe;
  WorldId world;
  Rigid3 camera_from_world;
  Rigid3 camera_from_keyframe;
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();  // as in PoseResult
  // Standard deviation of the camera's position where it is least certain, by the matches: large where they lie side by
  // side on one wall, above people, say, and position and rotation make up for each other.
  double sigma_m = std::numeric_limits<double>::infinity();
  std::vector<std::pair<std::uint32_t, PointId>> matches;  // keypoint and point, those that agree with the pose
  SurfaceAgreement surfaces;                               // of the query with the views of the place
  std::shared_ptr<const LocalMap> map;
};

// What a pose is worth depends on what hangs on it: a lost camera looks again in the next frame, a loop bends a map.
// By people before the camera wrong poses were found with up to 60 matches, of which no two in a row were the same.
// Before sigma was asked, matches on a strip of wall above people (sigma 17 to 47 mm) were off by up to 0.45 m. Of 267
// poses found by 50 matches or more in the kitchen with four people, cut to pieces, with 15 mm allowed, five were off
// by more than 0.15 m: three of them, and six of the others, had more than 8 mm.
struct PlaceBounds {
  int matches = 0;
  double surfaces = 0;     // share of what can be judged
  int judged = 0;          // samples
  double sigma_m = 0.008;  // twice that where there are kClearMatches
};
inline constexpr int kClearMatches = 100;
inline constexpr PlaceBounds kRelocalizationBounds{70, 0.9, 1000};
inline constexpr PlaceBounds kAgreeingBounds{30, 0.85, 1000};  // of two frames one after the other
inline constexpr PlaceBounds kLoopBounds{50, 0.85, 200};

[[nodiscard]] inline bool IsWithin(const PlaceFound& found, const PlaceBounds& bounds) {
  const double sigma_m = (std::ssize(found.matches) >= kClearMatches ? 2 : 1) * bounds.sigma_m;
  return std::ssize(found.matches) >= bounds.matches && found.surfaces.Judged() >= bounds.judged &&
         found.surfaces.Share() >= bounds.surfaces && found.sigma_m <= sigma_m;
}

// Looks for the pose of a query in a candidate's surroundings: matches by appearance, RANSAC over 3-D to 3-D
// alignments, optimization, more matches around the projections of all points there; then the depth images are held
// against each other, for no number of matches makes a pose right. Nothing where too few matches agree on one. Of a
// query without labels only what the views saw is asked, as people may stand in it. Re-entrant; the same input gives
// the same pose.
[[nodiscard]] std::optional<PlaceFound> VerifyPlace(const PlaceQuery& query, const PlaceCandidate& candidate,
                                                    const ScalePyramid& pyramid,
                                                    const PoseOptimizerOptions& options = {});

// Whether more speaks for a pose found than chance. Where all is full of texture, a wrong pose that takes one floor for
// another has a hundred matches, as any pose beside it has: of those of rooms of different buildings it had 0.6 to 1.1
// times as many as poses three degrees off, and at most a fifth of them were close. Of right ones in the kitchen with
// people it had 1.6 times as many or more, or more than half were close.
[[nodiscard]] bool IsBeyondChance(const PlaceQuery& query, const PlaceFound& found, const PlaceCandidate& candidate,
                                  const ScalePyramid& pyramid);

// The pose of a query in the same surroundings, looked for around one that is expected.
[[nodiscard]] std::optional<PlaceFound> VerifyPose(const PlaceQuery& query, const Rigid3& camera_from_world,
                                                   const PlaceCandidate& candidate, const ScalePyramid& pyramid,
                                                   const PoseOptimizerOptions& options = {});

}  // namespace rds
