// SPDX-License-Identifier: Apache-2.0
#include "mapping/local_mapper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <vector>

#include "testing/matchers.h"
#include "testing/unlocked_map.h"
#include "testing/view.h"

namespace rds {
namespace {

using testing::IsEmpty;

constexpr std::uint32_t kPoints = 30;

Keypoint At(double x, double y, double depth_m) {
  Keypoint keypoint;
  keypoint.x = keypoint.raw_x = static_cast<float>(x);
  keypoint.y = keypoint.raw_y = static_cast<float>(y);
  keypoint.depth_m = static_cast<float>(depth_m);
  keypoint.depth_sigma_m = static_cast<float>(TestCamera().depth_noise.Sigma_m(depth_m));
  return keypoint;
}

// Keypoints in a row, each `step_m` deeper than the one before.
std::vector<Keypoint> Row(std::size_t count, double first_depth_m = 2, double step_m = 0.01) {
  std::vector<Keypoint> keypoints;
  for (std::size_t i = 0; i < count; ++i) {
    const auto place = static_cast<double>(i);
    keypoints.push_back(At(10 + place * 10, 200, first_depth_m + place * step_m));
  }
  return keypoints;
}

struct Scene {
  Map map{ScalePyramid()};
  MappingOptions options;
  std::uint32_t frames = 0;

  Scene() { options.triangulate_neighbors = options.fuse_neighbors = 0; }
  [[nodiscard]] LocalMapper Mapper() const { return LocalMapper(options); }
  void Refine(LocalMapper& mapper, KeyframeId keyframe) {
    UnlockedMap access(map);
    mapper.Refine(access, keyframe);
  }
  // A candidate that tracked no point, at the origin of the world.
  [[nodiscard]] KeyframeCandidate Candidate(std::vector<Keypoint> keypoints) {
    KeyframeCandidate candidate;
    candidate.frame = FrameId{frames++};
    candidate.timestamp_s = 0.1 * frames;
    candidate.points.resize(keypoints.size());
    candidate.data = FrameOf(std::move(keypoints));
    return candidate;
  }
  // A candidate that shows the points 0 .. kPoints - 1 of the map in the first keypoints without depth, so that it
  // makes no point.
  [[nodiscard]] KeyframeCandidate Tracked(std::uint32_t points = kPoints) {
    KeyframeCandidate candidate = Candidate(Row(kPoints, 0, 0));
    candidate.reference = KeyframeId{0};
    for (std::uint32_t i = 0; i < points; ++i) {
      candidate.points[i] = PointId{i};
    }
    return candidate;
  }
};

TEST(LocalMapper, MakesPointsFromDepthWhereTheySeemToBe) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  KeyframeCandidate candidate = scene.Candidate({At(420, 240, 2), At(100, 100, 0), At(320, 340, 3)});
  candidate.camera_from_reference = {ExpSo3({0, 0.3, 0}), {0.5, 0, 0}};
  const KeyframeId id = mapper.Insert(scene.map, candidate);
  const Keyframe& keyframe = scene.map.At(id);
  EXPECT_THAT(keyframe.camera_from_world, RigidNear(candidate.camera_from_reference, 0.0, 1e-9));
  EXPECT_EQ(scene.map.point_count(), 2U);
  EXPECT_FALSE(keyframe.points[1].valid());  // no depth
  const auto in_camera = [&](std::size_t i) {
    return keyframe.camera_from_world * scene.map.At(keyframe.points[i]).position;
  };
  EXPECT_THAT(in_camera(0), MatrixNear(Eigen::Vector3d(0.4, 0, 2), 1e-6));
  EXPECT_THAT(in_camera(2), MatrixNear(Eigen::Vector3d(0, 0.6, 3), 1e-6));
}

TEST(LocalMapper, APoseHangsOnItsReferenceAsItIsNow) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  const KeyframeId root = mapper.Insert(scene.map, scene.Candidate(Row(kPoints)));
  KeyframeCandidate candidate = scene.Tracked();
  candidate.reference = root;
  candidate.camera_from_reference = {ExpSo3({0, 0.2, 0}), {0.1, 0, 0}};
  const Rigid3 corrected{ExpSo3({0.1, 0, 0}), {0, 0, 0.3}};  // after the candidate was made
  scene.map.SetPose(root, corrected);
  const KeyframeId id = mapper.Insert(scene.map, candidate);
  EXPECT_THAT(scene.map.At(id).camera_from_world, RigidNear(candidate.camera_from_reference * corrected, 1e-9, 1e-6));
  EXPECT_EQ(scene.map.At(id).parent, root);
  ASSERT_EQ(scene.map.At(id).covisible.size(), 1U);
  EXPECT_EQ(scene.map.At(id).covisible[0].shared_points, static_cast<int>(kPoints));
}

TEST(LocalMapper, BlockedKeypointsMakeNoPoint) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  KeyframeCandidate candidate = scene.Candidate(Row(kPoints));
  candidate.blocked = {3, 7};
  const Keyframe& keyframe = scene.map.At(mapper.Insert(scene.map, candidate));
  EXPECT_EQ(scene.map.point_count(), kPoints - 2);
  EXPECT_FALSE(keyframe.points[3].valid() || keyframe.points[7].valid());
}

TEST(LocalMapper, FarDepthMakesPointsToo) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  mapper.Insert(scene.map, scene.Candidate(Row(20, 2.75, 0.5)));  // up to 12 m
  EXPECT_EQ(scene.map.point_count(), 20U);
}

TEST(LocalMapper, NewPointsStartFromWhatTheirTracksKnow) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  KeyframeCandidate candidate = scene.Candidate(Row(kPoints));
  candidate.probabilities.assign(kPoints, kUnknownProbability);
  candidate.probabilities[4] = 0.15;
  candidate.probabilities[5] = 0.85;
  const Keyframe& keyframe = scene.map.At(mapper.Insert(scene.map, candidate));
  EXPECT_NEAR(scene.map.probabilities().Get(keyframe.points[4]), 0.15, 1e-6);
  EXPECT_NEAR(scene.map.probabilities().Get(keyframe.points[5]), 0.85, 1e-6);
  EXPECT_EQ(scene.map.probabilities().Get(keyframe.points[6]), kUnknownProbability);
}

TEST(LocalMapper, TrackedPointsAreLinkedAndCountedThroughFusions) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  const KeyframeId root = mapper.Insert(scene.map, scene.Candidate(Row(kPoints)));
  KeyframeCandidate candidate = scene.Tracked(20);
  candidate.uses = {{PointId{0}, 7, 3}, {PointId{25}, 4, 2}};
  scene.map.Forget(PointId{25}, root);      // gone while the candidate waited
  scene.map.Fuse(PointId{0}, PointId{29});  // now another point
  const Keyframe& keyframe = scene.map.At(mapper.Insert(scene.map, candidate));
  EXPECT_EQ(keyframe.points[0], PointId{29});
  EXPECT_EQ(scene.map.At(PointId{29}).visible, 1 + 1 + 7);
  EXPECT_EQ(scene.map.At(PointId{29}).found, 1 + 1 + 3);
  EXPECT_EQ(keyframe.points[1], PointId{1});
  EXPECT_EQ(scene.map.At(PointId{1}).observations.size(), 2U);
}

TEST(LocalMapper, PointsOnProbationGoIfTheyAreRarelyFound) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  mapper.Insert(scene.map, scene.Candidate(Row(kPoints)));
  KeyframeCandidate candidate = scene.Tracked();
  candidate.uses = {{PointId{0}, 9, 1}, {PointId{1}, 7, 1}};  // 2 of 10 and 2 of 8
  const KeyframeId id = mapper.Insert(scene.map, candidate);
  scene.Refine(mapper, id);
  EXPECT_EQ(scene.map.Find(PointId{0}), nullptr);
  EXPECT_NE(scene.map.Find(PointId{1}), nullptr);
  EXPECT_EQ(scene.map.point_count(), kPoints - 1);
  EXPECT_EQ(scene.map.At(id).covisible.at(0).shared_points, static_cast<int>(kPoints) - 1);
}

TEST(LocalMapper, PointsOnProbationGoIfTooFewKeyframesSeeThem) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  mapper.Insert(scene.map, scene.Candidate(Row(kPoints)));
  scene.Refine(mapper, mapper.Insert(scene.map, scene.Tracked(20)));
  EXPECT_EQ(scene.map.point_count(), kPoints);  // one keyframe later it is too early to tell
  scene.Refine(mapper, mapper.Insert(scene.map, scene.Tracked(20)));
  EXPECT_EQ(scene.map.point_count(), 20U);
  EXPECT_NE(scene.map.Find(PointId{19}), nullptr);
  EXPECT_EQ(scene.map.Find(PointId{20}), nullptr);
}

TEST(LocalMapper, TheProbationEnds) {
  Scene scene;
  LocalMapper mapper = scene.Mapper();
  mapper.Insert(scene.map, scene.Candidate(Row(kPoints)));
  for (int i = 0; i < scene.options.probation_keyframes; ++i) {
    scene.Refine(mapper, mapper.Insert(scene.map, scene.Tracked()));
  }
  KeyframeCandidate candidate = scene.Tracked();
  candidate.uses = {{PointId{0}, 100, 0}};
  scene.Refine(mapper, mapper.Insert(scene.map, candidate));
  EXPECT_NE(scene.map.Find(PointId{0}), nullptr);
}

// Keyframes 0 .. 4 that all see the same points; keyframe 1 sees them at `octave` and `alone` more that no other sees.
std::vector<KeyframeId> CullAmongFive(std::uint8_t octave, std::uint32_t alone, Map* map) {
  std::vector<Descriptor> descriptors(kPoints + alone);
  for (std::uint32_t k = 0; k < 5; ++k) {
    std::vector<Keypoint> keypoints = Row(kPoints + alone);
    for (Keypoint& keypoint : keypoints) {
      keypoint.octave = k == 1 ? octave : std::uint8_t{3};
    }
    const auto data = std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), descriptors);
    const KeyframeId id = map->AddKeyframe(FrameId{k}, k, {}, data);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      if (k == 0) {
        map->AddPoint({0.01 * i, 0, 2}, id, i);
      } else {
        EXPECT_TRUE(map->Observe(PointId{i}, id, i));
      }
    }
    for (std::uint32_t i = kPoints; k == 1 && i < kPoints + alone; ++i) {
      map->AddPoint({0.01 * i, 0, 2}, id, i);
    }
    map->UpdateCovisibility(id);
  }
  const std::vector<KeyframeId> before = map->keyframes();
  UnlockedMap access(*map);
  Scene().Mapper().CullKeyframes(access, map->newest());
  EXPECT_THAT(map->Validate(), IsEmpty());
  std::vector<KeyframeId> removed;
  std::ranges::set_difference(before, map->keyframes(), std::back_inserter(removed));
  return removed;
}

TEST(LocalMapper, CullsRedundantKeyframesButNeverTheRootOrTheNewest) {
  Map map{ScalePyramid()};
  const std::vector<KeyframeId> removed = CullAmongFive(3, 0, &map);
  // Once two are gone, three others no longer see the points of the next one.
  EXPECT_EQ(removed, (std::vector<KeyframeId>{KeyframeId{1}, KeyframeId{2}}));
  EXPECT_EQ(map.keyframes(), (std::vector<KeyframeId>{KeyframeId{0}, KeyframeId{3}, KeyframeId{4}}));
  EXPECT_EQ(map.point_count(), kPoints);
}

TEST(LocalMapper, KeepsAKeyframeThatSeesPointsFinerOrAlone) {
  const auto first_removed = [](std::uint8_t octave, std::uint32_t alone) {
    Map map{ScalePyramid()};
    return CullAmongFive(octave, alone, &map).at(0);
  };
  EXPECT_EQ(first_removed(2, 0), KeyframeId{1});  // one octave finer is nothing
  EXPECT_EQ(first_removed(1, 0), KeyframeId{2});
  EXPECT_EQ(first_removed(3, 1), KeyframeId{1});  // 30 of 31 points are well seen elsewhere
  EXPECT_EQ(first_removed(3, 2), KeyframeId{2});  // 30 of 32
}

}  // namespace
}  // namespace rds
