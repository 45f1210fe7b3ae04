// SPDX-License-Identifier: Apache-2.0
#include "place/place_search.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "base/error.h"
#include "feature/keypoint_observation.h"
#include "feature/matching.h"
#include "optim/pose_optimizer.h"
#include "place/projection_search.h"
#include "place/recovery.h"
#include "propagation/surface_labels.h"

namespace rds {
namespace {

constexpr std::size_t kGroupScores = 5;  // covisible keyframes whose scores count with one's own
constexpr std::size_t kAlike = 10;       // best covisible keyframes of one that is chosen, which are not
constexpr std::size_t kGroup = 9;        // covisible keyframes whose points are matched by appearance
constexpr LocalMapOptions kSurroundings{20, 5};
constexpr std::size_t kViews = 4;  // beside the keyframe's own
constexpr int kMostDistance = 60;  // Hamming
constexpr double kRatio = 0.85;
constexpr int kLeastMatches = 12;
constexpr int kLeastAgreeing = 10;
constexpr double kWide_px = 10;   // around projections by a first pose
constexpr double kNarrow_px = 4;  // by a better one
constexpr double kSearchRatio = 0.8;
constexpr double kBeside_rad = 0.05;    // of poses that are held against one
constexpr double kBeyondChance = 1.35;  // times as many matches as those have
constexpr int kCloseDistance = 50;      // Hamming
constexpr double kCloseShare = 0.35;
constexpr int kDynamicReach_px = 100;  // along its surface from a keypoint that is dynamic

// Matches of the candidate's points to all keypoints that are not dynamic, each keypoint once.
std::vector<PointMatch> MatchByAppearance(const PlaceQuery& query, const PlaceCandidate& candidate) {
  const std::span<const Descriptor> descriptors = query.data->descriptors();
  MatchSet set(query.data->size());
  for (const std::uint32_t point : candidate.points) {
    if (candidate.left_out[point] != 0) {
      continue;
    }
    int best = 257;
    int second = 257;
    std::uint32_t keypoint = 0;
    for (std::uint32_t i = 0; i < descriptors.size(); ++i) {
      const int distance = HammingDistance(candidate.map->descriptors[point], descriptors[i]);
      if (distance < best) {
        second = best;
        best = distance;
        keypoint = i;
      } else if (distance < second) {
        second = distance;
      }
    }
    const bool is_usable = query.labels.empty() || query.labels[keypoint] != KeypointLabel::kDynamic;
    if (best <= kMostDistance && best <= kRatio * second && is_usable) {
      set.Add({point, keypoint, best});
    }
  }
  std::vector<PointMatch> matches;
  for (const Match& match : set.Take()) {
    matches.push_back({match.keypoint, match.query, PointState::kUnknown, 1.0});
  }
  return matches;
}

// A pose and what agrees with it.
struct Estimate {
  PoseResult pose;
  std::vector<PointMatch> matches;
};

Estimate Optimized(const PlaceQuery& query, const LocalMap& map, const Rigid3& initial,
                   const std::vector<PointMatch>& matches, const ScalePyramid& pyramid,
                   const PoseOptimizerOptions& options) {
  std::vector<PoseObservation> observations;
  for (const PointMatch& match : matches) {
    observations.push_back(
        {map.Position(match.point), ObservationOf(query.data->keypoints()[match.keypoint], pyramid, match.weight)});
  }
  Estimate estimate{OptimizePose(query.data->camera(), initial, observations, options), {}};
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (estimate.pose.inlier[i] != 0) {
      estimate.matches.push_back(matches[i]);
    }
  }
  return estimate;
}

// One flag for each point.
std::vector<std::uint8_t> LeftOut(const LocalMap& map, const MovingProbabilities& probabilities,
                                  std::span<const PointId> known) {
  std::vector<std::uint8_t> left_out(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    const bool is_known = std::ranges::binary_search(known, map.ids[i]);
    left_out[i] = is_known || probabilities.State(map.ids[i]) == PointState::kDynamic ? 1 : 0;
  }
  return left_out;
}

// One for each sample of the depth grid, 0 where it is dynamic; empty without labels: all may be asked.
std::vector<std::uint8_t> StaticSamples(const FrameData& data, std::span<const KeypointLabel> labels) {
  std::vector<std::uint8_t> usable;
  if (!labels.empty()) {
    for (const SurfaceLabel& label : SpreadLabels(data, labels, kDynamicReach_px)) {
      usable.push_back(label.dynamic ? 0 : 1);
    }
  }
  return usable;
}

SurfaceAgreement HoldAgainst(const PlaceQuery& query, const Rigid3& camera_from_world,
                             const PlaceCandidate& candidate) {
  SurfaceAgreement agreement;
  const std::vector<std::uint8_t> own = StaticSamples(*query.data, query.labels);
  for (const PlaceCandidate::View& view : candidate.views) {
    const Rigid3 view_from_camera = view.camera_from_world * camera_from_world.Inverse();
    agreement +=
        CompareSurfaces(*view.data, StaticSamples(*view.data, view.labels), *query.data, view_from_camera.Inverse(), 1);
    if (!query.labels.empty()) {
      agreement += CompareSurfaces(*query.data, own, *view.data, view_from_camera, 1);
    }
  }
  return agreement;
}

double PositionSigma_m(const Eigen::Matrix<double, 6, 6>& information) {
  const Eigen::Matrix3d covariance = information.inverse().topLeftCorner<3, 3>();
  const double most =
      covariance.allFinite() ? Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().maxCoeff() : -1;
  return most >= 0 ? std::sqrt(most) : std::numeric_limits<double>::infinity();
}

// One flag for each keypoint.
std::vector<std::uint8_t> DynamicKeypoints(const PlaceQuery& query) {
  std::vector<std::uint8_t> dynamic(query.data->size(), 0);
  for (std::size_t i = 0; i < query.labels.size(); ++i) {
    dynamic[i] = query.labels[i] == KeypointLabel::kDynamic ? 1 : 0;
  }
  return dynamic;
}

// Matches around the projections of all static points, from coarse to fine; then the surfaces.
std::optional<PlaceFound> Refine(const PlaceQuery& query, Estimate estimate, const PlaceCandidate& candidate,
                                 const ScalePyramid& pyramid, const PoseOptimizerOptions& options) {
  const LocalMap& map = *candidate.map;
  for (const double window_px : {kWide_px, kNarrow_px}) {
    std::vector<std::uint8_t> taken = candidate.left_out;
    std::vector<std::uint8_t> occupied = DynamicKeypoints(query);
    for (const PointMatch& match : estimate.matches) {
      taken[match.point] = 1;
      occupied[match.keypoint] = 1;
    }
    LocalSearch search = SearchLocalMap(*query.data, estimate.pose.camera_from_world, map, pyramid, taken, occupied,
                                        window_px, kSearchRatio);
    search.matches.insert(search.matches.end(), estimate.matches.begin(), estimate.matches.end());
    std::ranges::sort(search.matches, {}, &PointMatch::keypoint);
    estimate = Optimized(query, map, estimate.pose.camera_from_world, search.matches, pyramid, options);
    if (std::ssize(estimate.matches) < kLeastAgreeing) {
      return std::nullopt;
    }
  }
  PlaceFound found;
  found.keyframe = candidate.keyframe;
  found.world = candidate.world;
  found.camera_from_world = estimate.pose.camera_from_world;
  found.camera_from_keyframe = found.camera_from_world * candidate.keyframe_from_world.Inverse();
  found.information = estimate.pose.information;
  found.sigma_m = PositionSigma_m(found.information);
  for (const PointMatch& match : estimate.matches) {
    found.matches.emplace_back(match.keypoint, map.ids[match.point]);
  }
  found.surfaces = HoldAgainst(query, found.camera_from_world, candidate);
  found.map = candidate.map;
  return found;
}

}  // namespace

std::vector<Descriptor> PlaceQuery::Descriptors() const {
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < data->size(); ++i) {
    if (labels.empty() || labels[i] != KeypointLabel::kDynamic) {
      descriptors.push_back(data->descriptors()[i]);
    }
  }
  return descriptors;
}

std::vector<Descriptor> IndexedDescriptors(const Map& map, KeyframeId id) {
  const Keyframe& keyframe = map.At(id);
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
    const bool is_dynamic =
        (keyframe.IsLabeled() && keyframe.labels[i] == KeypointLabel::kDynamic) ||
        (keyframe.points[i].valid() && map.probabilities().State(keyframe.points[i]) == PointState::kDynamic);
    if (keyframe.points[i].valid() && !is_dynamic) {
      descriptors.push_back(keyframe.data->descriptors()[i]);
    }
  }
  return descriptors;
}

std::vector<KeyframeId> ProposePlaces(const Map& map, std::span<const PlaceScore> scores, std::size_t most,
                                      const std::function<bool(const Keyframe&)>& is_wanted) {
  std::vector<float> own(map.keyframes().empty() ? 0 : map.newest().index() + 1, 0.0F);
  for (const PlaceScore& score : scores) {
    if (score.keyframe.index() < own.size()) {
      own[score.keyframe.index()] = score.score;
    }
  }
  std::vector<PlaceScore> groups;
  for (const PlaceScore& score : scores) {
    const Keyframe* const keyframe = map.Find(score.keyframe);
    if (keyframe == nullptr || !is_wanted(*keyframe)) {
      continue;
    }
    PlaceScore group = score;
    for (std::size_t i = 0; i < std::min(kGroupScores, keyframe->covisible.size()); ++i) {
      group.score += own[keyframe->covisible[i].keyframe.index()];
    }
    groups.push_back(group);
  }
  std::ranges::stable_sort(groups, std::ranges::greater(), &PlaceScore::score);
  std::vector<KeyframeId> chosen;
  std::unordered_set<KeyframeId> alike;
  for (const PlaceScore& group : groups) {
    if (chosen.size() >= most) {
      break;
    }
    if (!alike.contains(group.keyframe)) {
      chosen.push_back(group.keyframe);
      alike.insert(group.keyframe);
      for (const KeyframeId other : map.BestCovisible(group.keyframe, kAlike)) {
        alike.insert(other);
      }
    }
  }
  return chosen;
}

std::optional<PlaceCandidate> PlanPlace(const Map& map, KeyframeId id, std::span<const PointId> known) {
  const Keyframe* const keyframe = map.Find(id);
  if (keyframe == nullptr) {
    return std::nullopt;
  }
  PlaceCandidate candidate;
  candidate.keyframe = id;
  candidate.world = keyframe->world;
  candidate.keyframe_from_world = keyframe->camera_from_world;
  candidate.map = BuildLocalMap(map, id, kSurroundings);
  candidate.left_out = LeftOut(*candidate.map, map.probabilities(), known);
  std::vector<KeyframeId> group = map.BestCovisible(id, kGroup);
  group.insert(group.begin(), id);
  std::vector<std::uint8_t> in_group(candidate.map->size(), 0);
  for (const KeyframeId member : group) {
    if (const LocalKeyframe* const local = candidate.map->Find(member)) {
      for (const LocalKeyframe::Link& link : local->links) {
        in_group[link.point] = 1;
      }
    }
  }
  for (std::uint32_t i = 0; i < in_group.size(); ++i) {
    if (in_group[i] != 0) {
      candidate.points.push_back(i);
    }
  }
  for (std::size_t i = 0; i < std::min(kViews + 1, group.size()); ++i) {
    const Keyframe& view = map.At(group[i]);
    candidate.views.push_back({view.data, view.camera_from_world, view.labels});
  }
  return candidate;
}

std::optional<PlaceFound> VerifyPlace(const PlaceQuery& query, const PlaceCandidate& candidate,
                                      const ScalePyramid& pyramid, const PoseOptimizerOptions& options) {
  Check(query.labels.empty() || query.labels.size() == query.data->size(), "a label for each keypoint");
  const std::vector<PointMatch> matches = MatchByAppearance(query, candidate);
  if (std::ssize(matches) < kLeastMatches) {
    return std::nullopt;
  }
  const auto first = RansacPose(*query.data, matches, *candidate.map, pyramid, kLeastAgreeing);
  if (!first) {
    return std::nullopt;
  }
  return Refine(query, Optimized(query, *candidate.map, *first, matches, pyramid, options), candidate, pyramid,
                options);
}

std::optional<PlaceFound> VerifyPose(const PlaceQuery& query, const Rigid3& camera_from_world,
                                     const PlaceCandidate& candidate, const ScalePyramid& pyramid,
                                     const PoseOptimizerOptions& options) {
  Check(query.labels.empty() || query.labels.size() == query.data->size(), "a label for each keypoint");
  Estimate estimate;
  estimate.pose.camera_from_world = camera_from_world;
  return Refine(query, std::move(estimate), candidate, pyramid, options);
}

bool IsBeyondChance(const PlaceQuery& query, const PlaceFound& found, const PlaceCandidate& candidate,
                    const ScalePyramid& pyramid) {
  const LocalMap& map = *candidate.map;
  const auto is_close = [&](const std::pair<std::uint32_t, PointId>& match) {
    const auto point = map.IndexOf(match.second);
    return point && HammingDistance(map.descriptors[*point], query.data->descriptors()[match.first]) <= kCloseDistance;
  };
  const auto matches = static_cast<double>(found.matches.size());
  if (static_cast<double>(std::ranges::count_if(found.matches, is_close)) >= kCloseShare * matches) {
    return true;
  }
  const std::vector<std::uint8_t> dynamic = DynamicKeypoints(query);
  const std::array<Eigen::Vector3d, 4> turns{
      {{kBeside_rad, 0, 0}, {-kBeside_rad, 0, 0}, {0, kBeside_rad, 0}, {0, -kBeside_rad, 0}}};
  double by_chance = 0;
  for (const Eigen::Vector3d& turn : turns) {
    const Rigid3 beside = Rigid3{ExpSo3(turn), Eigen::Vector3d::Zero()} * found.camera_from_world;
    const LocalSearch search =
        SearchLocalMap(*query.data, beside, map, pyramid, candidate.left_out, dynamic, kNarrow_px, kSearchRatio);
    by_chance += static_cast<double>(search.matches.size()) / turns.size();
  }
  return matches >= kBeyondChance * by_chance;
}

}  // namespace rds
