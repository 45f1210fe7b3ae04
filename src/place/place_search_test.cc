// SPDX-License-Identifier: Apache-2.0
#include "place/place_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "place/projection_search.h"
#include "testing/matchers.h"
#include "testing/ring_world.h"

namespace rds {
namespace {

// Half a ring that is mapped and indexed.
struct Scene {
  RingWorld world;
  Map map{ScalePyramid()};
  std::vector<KeyframeId> ids;
  PlaceIndex index;

  explicit Scene(const RingOptions& options = {.keyframes = 60, .rounds = 0.5}) : world(options) {
    ids = world.AddTo(map, 0, options.keyframes);
    for (const KeyframeId id : ids) {
      index.Add(id, IndexedDescriptors(map, id));
    }
  }
  [[nodiscard]] std::vector<KeyframeId> Propose(const PlaceQuery& query, std::size_t most = 5) const {
    return ProposePlaces(map, index.Query(query.Descriptors()), most, [](const Keyframe& /*any*/) { return true; });
  }
  [[nodiscard]] std::optional<PlaceFound> Find(const PlaceQuery& query) const {
    std::optional<PlaceFound> best;
    for (const KeyframeId candidate : Propose(query)) {
      auto found = VerifyPlace(query, *PlanPlace(map, candidate), ScalePyramid());
      if (found && (!best || found->matches.size() > best->matches.size())) {
        best = std::move(found);
      }
    }
    return best;
  }
};

// Between the keyframes, and off the path.
Rigid3 Aside(const RingWorld& world, double angle) {
  return Rigid3{ExpSo3({0, 0.15, 0}), {0.2, 0, 0.1}} * world.PoseAt(angle);
}

TEST(PlaceSearch, FindsFramesAnywhereInTheMap) {
  const Scene scene;
  const Rigid3 map_from_truth = scene.map.At(scene.ids[0]).camera_from_world.Inverse() * scene.world.truth[0];
  for (const double angle : {0.1, 0.9, 1.7, 2.6}) {
    const Rigid3 pose = Aside(scene.world, angle);
    const auto found = scene.Find({scene.world.Look(pose, 77).data, {}});
    ASSERT_TRUE(found.has_value()) << angle;
    EXPECT_TRUE(IsWithin(*found, kRelocalizationBounds)) << angle;
    EXPECT_TRUE(IsWithin(*found, kLoopBounds)) << angle;
    EXPECT_THAT(found->camera_from_world, RigidNear(pose * map_from_truth.Inverse(), 0.06, 0.5)) << angle;
    EXPECT_THAT(found->camera_from_keyframe * scene.map.At(found->keyframe).camera_from_world,
                RigidNear(found->camera_from_world, 1e-9, 1e-6));
  }
}

TEST(PlaceSearch, FindsNothingElsewhere) {
  const Scene scene;
  const RingWorld elsewhere({.seed = 99});
  for (double angle = 0; angle < 6; angle += 0.3) {
    const auto found = scene.Find({elsewhere.Look(elsewhere.PoseAt(angle), 5).data, {}});
    EXPECT_FALSE(found && IsWithin(*found, kRelocalizationBounds)) << angle;
  }
  const auto unseen = scene.Find({scene.world.Look(scene.world.PoseAt(4.7), 5).data, {}});  // the other half
  EXPECT_FALSE(unseen && IsWithin(*unseen, kRelocalizationBounds));
}

// The same posters on other walls: matches agree, surfaces do not.
TEST(PlaceSearch, WhatOnlyLooksTheSameIsGivenAwayByItsSurfaces) {
  const Scene scene;
  const Rigid3 pose = scene.world.PoseAt(1);
  const RingWorld::View view = scene.world.Look(pose, 5);
  std::vector<float> depth_m = view.data->depth_grid().depth_m();
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    depth_m[i] *= i % 80 < 50 ? 0.7F : 1.0F;  // a wall comes forward
  }
  const DepthGrid grid(view.data->depth_grid().columns(), view.data->depth_grid().rows(), depth_m);
  const FrameData& data = *view.data;
  const auto changed = std::make_shared<const FrameData>(
      data.camera(), std::vector<Keypoint>(data.keypoints().begin(), data.keypoints().end()),
      std::vector<Descriptor>(data.descriptors().begin(), data.descriptors().end()), grid);
  const std::vector<KeypointLabel> all_static(data.size(), KeypointLabel::kStatic);
  const auto found = scene.Find({changed, all_static});
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(found->matches.size(), 50U);
  EXPECT_LT(found->surfaces.Share(), kRelocalizationBounds.surfaces);
}

// Planks and stains look like planks and stains: any pose has matches, the right one more of them, or closer ones.
TEST(PlaceSearch, WhatChanceMatchesAnywhereDoesNotSpeakForAPose) {
  const RingOptions options{.keyframes = 60, .rounds = 0.5, .landmarks_per_m = 800, .variety = 40};
  const Scene scene(options);
  RingOptions other = options;
  other.seed = 99;
  const RingWorld elsewhere(other);
  const Rigid3 map_from_truth = scene.map.At(scene.ids[0]).camera_from_world.Inverse() * scene.world.truth[0];
  for (const std::size_t i : {10U, 25U, 40U}) {
    const auto candidate = PlanPlace(scene.map, scene.ids[i]);
    ASSERT_TRUE(candidate.has_value());
    const Rigid3 pose = Aside(scene.world, std::numbers::pi * static_cast<double>(i) / 60);
    const auto found = [&](const PlaceQuery& query) {
      const std::vector<std::uint8_t> occupied(query.data->size(), 0);
      PlaceFound there;
      there.camera_from_world = pose * map_from_truth.Inverse();
      for (const PointMatch& match : SearchLocalMap(*query.data, there.camera_from_world, *candidate->map,
                                                    ScalePyramid(), candidate->left_out, occupied, 4, 0.8)
                                         .matches) {
        there.matches.emplace_back(match.keypoint, candidate->map->ids[match.point]);
      }
      return there;
    };
    const PlaceQuery here{scene.world.Look(pose, 5).data, {}};
    const PlaceQuery there{elsewhere.Look(pose, 5).data, {}};
    const PlaceFound right = found(here);
    const PlaceFound wrong = found(there);
    EXPECT_GE(wrong.matches.size(), 50U) << i;
    EXPECT_TRUE(IsBeyondChance(here, right, *candidate, ScalePyramid())) << i;
    EXPECT_FALSE(IsBeyondChance(there, wrong, *candidate, ScalePyramid())) << i;
  }
}

// Above people there may be a strip of wall only, where position and rotation make up for each other.
TEST(PlaceSearch, MatchesSideBySideMakeAPoseUncertain) {
  const Scene scene;
  const RingWorld::View view = scene.world.Look(scene.world.PoseAt(1), 5);
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < view.data->size(); ++i) {
    if (view.data->keypoints()[i].y < 120) {
      keypoints.push_back(view.data->keypoints()[i]);
      descriptors.push_back(view.data->descriptors()[i]);
    }
  }
  const auto strip = scene.Find(
      {std::make_shared<const FrameData>(TestCamera(), keypoints, descriptors, view.data->depth_grid()), {}});
  auto whole = scene.Find({view.data, {}});
  ASSERT_TRUE(strip && whole);
  EXPECT_LT(whole->sigma_m, 0.01);
  EXPECT_GT(strip->sigma_m, 2 * whole->sigma_m);
  ASSERT_TRUE(IsWithin(*whole, kRelocalizationBounds) && IsWithin(*whole, kLoopBounds));
  whole->sigma_m = 0.03;
  EXPECT_FALSE(IsWithin(*whole, kRelocalizationBounds) || IsWithin(*whole, kAgreeingBounds) ||
               IsWithin(*whole, kLoopBounds));
}

// Somebody stands before the camera: what the earlier views saw is hidden, not contradicted.
TEST(PlaceSearch, PeopleInAQueryWithoutLabelsDoNotSpeakAgainstIt) {
  const Scene scene;
  const RingWorld::View view = scene.world.Look(scene.world.PoseAt(1), 5);
  std::vector<float> depth_m = view.data->depth_grid().depth_m();
  for (std::size_t i = 0; i < depth_m.size(); ++i) {
    depth_m[i] = i % 80 < 30 ? 0.6F : depth_m[i];
  }
  const DepthGrid grid(view.data->depth_grid().columns(), view.data->depth_grid().rows(), depth_m);
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (std::size_t i = 0; i < view.data->size(); ++i) {
    if (view.data->keypoints()[i].x >= 30 * 8) {
      keypoints.push_back(view.data->keypoints()[i]);
      descriptors.push_back(view.data->descriptors()[i]);
    }
  }
  const auto found = scene.Find({std::make_shared<const FrameData>(TestCamera(), keypoints, descriptors, grid), {}});
  ASSERT_TRUE(found.has_value());
  EXPECT_TRUE(IsWithin(*found, kRelocalizationBounds));
}

TEST(PlaceSearch, WhatIsDynamicIsNeitherIndexedNorAskedFor) {
  Scene scene;
  const KeyframeId id = scene.ids[20];
  const std::size_t before = IndexedDescriptors(scene.map, id).size();
  const std::size_t keypoints = scene.map.At(id).data->size();
  std::vector<KeypointLabel> labels(keypoints, KeypointLabel::kStatic);
  for (std::size_t i = 0; i < keypoints / 2; ++i) {
    labels[i] = KeypointLabel::kDynamic;
  }
  scene.map.Label(id, labels);
  const std::size_t after = IndexedDescriptors(scene.map, id).size();
  EXPECT_LT(after, 0.6 * static_cast<double>(before));
  EXPECT_GT(after, 0.4 * static_cast<double>(before));
  const PlaceQuery query{scene.map.At(id).data, labels};
  EXPECT_EQ(query.Descriptors().size(), keypoints - keypoints / 2);
  const auto found = scene.Find(query);
  ASSERT_TRUE(found.has_value());
  for (const auto& [keypoint, point] : found->matches) {
    EXPECT_GE(keypoint, keypoints / 2);
    EXPECT_NE(scene.map.probabilities().State(point), PointState::kDynamic);
  }
}

// A keyframe that sees the points of a place has not found it again.
TEST(PlaceSearch, PointsThatTheQueryKnowsDoNotCount) {
  const Scene scene;
  const PlaceQuery query{scene.world.Look(scene.world.truth[20], 5).data, {}};
  const auto found = VerifyPlace(query, *PlanPlace(scene.map, scene.ids[20]), ScalePyramid());
  ASSERT_TRUE(found && IsWithin(*found, kLoopBounds));
  std::vector<PointId> known;
  for (const auto& [keypoint, point] : found->matches) {
    known.push_back(point);
  }
  std::ranges::sort(known);
  const auto rest = VerifyPlace(query, *PlanPlace(scene.map, scene.ids[20], known), ScalePyramid());
  EXPECT_FALSE(rest && IsWithin(*rest, kLoopBounds));
  known.resize(known.size() / 2);
  const auto half = VerifyPlace(query, *PlanPlace(scene.map, scene.ids[20], known), ScalePyramid());
  ASSERT_TRUE(half.has_value());
  EXPECT_GT(half->matches.size(), found->matches.size() / 4);
  for (const auto& [keypoint, point] : half->matches) {
    EXPECT_FALSE(std::ranges::binary_search(known, point));
  }
}

TEST(PlaceSearch, CandidatesAreDifferentPlaces) {
  const Scene scene;
  const PlaceQuery query{scene.world.Look(scene.world.PoseAt(1.5), 3).data, {}};
  const std::vector<KeyframeId> proposed = scene.Propose(query, 4);
  ASSERT_GE(proposed.size(), 2U);
  for (std::size_t i = 0; i < proposed.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_THAT(scene.map.BestCovisible(proposed[k], 10), testing::Not(testing::Contains(proposed[i])));
    }
  }
  EXPECT_TRUE(ProposePlaces(scene.map, scene.index.Query(query.Descriptors()), 4, [](const Keyframe& /*none*/) {
                return false;
              }).empty());
}

TEST(PlaceSearch, KeyframesThatAreGoneAreNoCandidates) {
  Scene scene;
  const PlaceQuery query{scene.world.Look(scene.world.PoseAt(1.5), 3).data, {}};
  const KeyframeId first = scene.Propose(query).front();
  scene.map.EraseKeyframe(first);
  EXPECT_THAT(scene.Propose(query), testing::Not(testing::Contains(first)));
  EXPECT_FALSE(PlanPlace(scene.map, first).has_value());
}

}  // namespace
}  // namespace rds
