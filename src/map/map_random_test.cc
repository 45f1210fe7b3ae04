// SPDX-License-Identifier: Apache-2.0
// Random operations of every kind, after which every invariant of the map must hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "base/random.h"
#include "map/local_map.h"
#include "map/map.h"
#include "testing/view.h"

namespace rds {
namespace {

using testing::IsEmpty;

constexpr std::uint32_t kKeypoints = 60;

std::shared_ptr<const FrameData> Data(Random& random) {
  std::vector<Keypoint> keypoints(kKeypoints);
  std::vector<Descriptor> descriptors(kKeypoints);
  for (std::uint32_t i = 0; i < kKeypoints; ++i) {
    keypoints[i].x = keypoints[i].raw_x = static_cast<float>(random.Uniform(0, 639));
    keypoints[i].y = keypoints[i].raw_y = static_cast<float>(random.Uniform(0, 479));
    keypoints[i].octave = static_cast<std::uint8_t>(random.Index(8));
    descriptors[i] = {random.Bits(), random.Bits(), random.Bits(), random.Bits()};
  }
  return std::make_shared<const FrameData>(TestCamera(), std::move(keypoints), std::move(descriptors));
}

Rigid3 Pose(Random& random) {
  const auto number = [&] { return random.Uniform(-1, 1); };
  return {ExpSo3({number(), number(), number()}), {number(), number(), number()}};
}

// Works on a map as the mapper, the semantic thread and a loop closer would, only without any sense.
class Chaos {
 public:
  explicit Chaos(std::uint64_t seed) : random_(seed) { AddKeyframe(); }

  // One operation; which one it was.
  std::size_t Step() {
    static constexpr std::array kWeights = {6, 20, 40, 8, 4, 4, 2, 3, 2, 6, 2, 4, 1, 1, 1, 3};
    std::uint32_t all = 0;
    for (const int weight : kWeights) {
      all += static_cast<std::uint32_t>(weight);
    }
    std::uint32_t choice = random_.Index(all);
    std::size_t kind = 0;
    while (choice >= static_cast<std::uint32_t>(kWeights[kind])) {
      choice -= static_cast<std::uint32_t>(kWeights[kind++]);
    }
    Do(kind);
    return kind;
  }
  static constexpr std::size_t kKinds = 16;
  Map& map() { return map_; }

 private:
  void Do(std::size_t kind) {
    switch (kind) {
      case 0:
        return AddKeyframe();
      case 1:
        return AddPoint();
      case 2:
        return Observe();
      case 3:
        return Forget();
      case 4:
        return Fuse();
      case 5:
        return Label();
      case 6:
        return EraseKeyframe();
      case 7:
        return map_.UpdateCovisibility(AnyKeyframe());
      case 8:
        return ErasePoint();
      case 9:
        return Plan();
      case 10:
        return SetPose();
      case 11:
        return Move();
      case 12:
        return StartWorld();
      case 13:
        return Merge();
      case 14:
        return Bend();
      default:
        return Apply();
    }
  }

  KeyframeId AnyKeyframe() {
    const auto& ids = map_.keyframes();
    return ids[random_.Index(static_cast<std::uint32_t>(ids.size()))];
  }
  PointId AnyPoint() {
    const auto ids = map_.Points();
    return ids.empty() ? PointId{} : ids[random_.Index(static_cast<std::uint32_t>(ids.size()))];
  }
  std::uint32_t AnyKeypoint() { return random_.Index(kKeypoints); }

  void AddKeyframe() { AddKeyframe(map_.keyframes().empty() ? WorldId{} : map_.At(AnyKeyframe()).world); }
  void AddKeyframe(WorldId world) {
    const KeyframeId id = map_.AddKeyframe(FrameId{frame_}, frame_, Pose(random_), Data(random_), world);
    frame_ += 1 + random_.Index(3);
    for (std::uint32_t i = 0; i < 30; ++i) {  // what it tracked
      const PointId point = AnyPoint();
      if (point.valid() && map_.WorldOf(map_.At(point).reference) == map_.At(id).world) {
        map_.Observe(point, id, i);
      }
    }
    map_.UpdateCovisibility(id);
  }
  void StartWorld() { AddKeyframe(map_.AddWorld()); }
  void AddPoint() {
    const KeyframeId keyframe = AnyKeyframe();
    const std::uint32_t keypoint = AnyKeypoint();
    if (!map_.At(keyframe).points[keypoint].valid()) {
      map_.AddPoint({random_.Uniform(-2, 2), random_.Uniform(-2, 2), 3}, keyframe, keypoint);
    }
  }
  void Observe() {
    const PointId point = AnyPoint();
    const KeyframeId keyframe = AnyKeyframe();
    if (point.valid() && map_.WorldOf(map_.At(point).reference) == map_.At(keyframe).world) {
      map_.Observe(point, keyframe, AnyKeypoint());
      map_.UpdateAppearance(point);
    }
  }
  void Forget() {
    if (const PointId point = AnyPoint(); point.valid()) {
      const auto& observations = map_.At(point).observations;
      map_.Forget(point, observations[random_.Index(static_cast<std::uint32_t>(observations.size()))].keyframe);
    }
  }
  void Fuse() {
    const PointId from = AnyPoint();
    const PointId to = AnyPoint();
    if (from.valid() && from != to && map_.WorldOf(map_.At(from).reference) == map_.WorldOf(map_.At(to).reference)) {
      map_.Fuse(from, to);
    }
  }
  void Label() {
    const KeyframeId keyframe = AnyKeyframe();
    if (!map_.At(keyframe).IsLabeled()) {
      std::vector<KeypointLabel> labels;
      for (std::uint32_t i = 0; i < kKeypoints; ++i) {
        labels.push_back(static_cast<KeypointLabel>(random_.Index(3)));
      }
      map_.Label(keyframe, std::move(labels));
    }
  }
  void EraseKeyframe() {
    if (const KeyframeId keyframe = AnyKeyframe(); !map_.IsRoot(keyframe)) {
      map_.EraseKeyframe(keyframe);
    }
  }
  void ErasePoint() {
    if (const PointId point = AnyPoint(); point.valid()) {
      map_.ErasePoint(point);
    }
  }
  void SetPose() { map_.SetPose(AnyKeyframe(), Pose(random_)); }
  void Move() {
    if (const PointId point = AnyPoint(); point.valid()) {
      map_.Move(point, {random_.Uniform(-2, 2), random_.Uniform(-2, 2), 3});
    }
  }
  void Merge() {
    const KeyframeId child = AnyKeyframe();
    const KeyframeId parent = AnyKeyframe();
    if (map_.At(child).world != map_.At(parent).world) {
      map_.Merge(child, parent, Pose(random_));
    }
  }
  void Bend() {
    std::vector<Map::WorldMove> moves;
    const WorldId world = map_.At(AnyKeyframe()).world;
    for (const KeyframeId id : map_.keyframes()) {
      if (map_.At(id).world == world && (map_.IsRoot(id) || random_.Index(2) == 0)) {
        moves.push_back({id, Pose(random_)});
      }
    }
    map_.Bend(moves);
  }
  KeyframeVersion Version(KeyframeId id) { return {id, map_.At(id).pose_revision}; }
  // A correction of the map as it is now, to be applied some operations later.
  void Plan() {
    Correction correction;
    for (int i = 0; i < 3; ++i) {
      correction.poses.push_back({Version(AnyKeyframe()), Pose(random_), random_.Index(2) == 0});
      const PointId point = AnyPoint();
      if (!point.valid()) {
        continue;
      }
      const MapPoint& now = map_.At(point);
      correction.points.push_back({point, now.revision, Version(now.reference), {0, 0, random_.Uniform(1, 4)}});
      correction.removals.push_back({AnyPoint(), AnyKeyframe()});
      const KeyframeId a = AnyKeyframe();
      const KeyframeId b = AnyKeyframe();
      if (map_.At(a).world == map_.At(b).world && a != b) {
        correction.new_points.push_back({{1, 2, 3}, Version(a), AnyKeypoint(), Version(b), AnyKeypoint()});
      }
      if (map_.WorldOf(now.reference) == map_.At(a).world) {
        correction.matches.push_back({point, Version(a), AnyKeypoint()});
      }
    }
    planned_.push_back(std::move(correction));
  }
  void Apply() {
    if (!planned_.empty()) {
      map_.Apply(planned_.front());
      planned_.erase(planned_.begin());
    }
  }

  Random random_;
  Map map_{ScalePyramid(), {}, 64};
  std::uint32_t frame_ = 0;
  std::vector<Correction> planned_;
};

TEST(MapRandom, EveryInvariantHoldsAfterTenThousandOperations) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Chaos chaos(seed);
    std::array<int, Chaos::kKinds> counts{};
    for (int step = 1; step <= 10'000; ++step) {
      ++counts[chaos.Step()];
      if (step % 100 == 0) {
        ASSERT_THAT(chaos.map().Validate(), IsEmpty()) << "seed " << seed << ", step " << step;
        const auto local = BuildLocalMap(chaos.map(), chaos.map().newest(), {});
        ASSERT_GT(local->keyframes.size(), 0U);
      }
    }
    EXPECT_THAT(counts, testing::Each(testing::Gt(50)));
    EXPECT_GT(chaos.map().point_count(), 50U);
  }
}

// What a keyframe's edges say is true right after they were recomputed.
TEST(MapRandom, CovisibilityCountsTheSharedPoints) {
  Chaos chaos(4);
  for (int step = 1; step <= 2'000; ++step) {
    chaos.Step();
    if (step % 50 != 0) {
      continue;
    }
    Map& map = chaos.map();
    const KeyframeId id = map.newest();
    map.UpdateCovisibility(id);
    for (const KeyframeId other : map.keyframes()) {
      int shared = 0;
      for (const PointId point : map.At(id).points) {
        shared += point.valid() && std::ranges::count(map.At(other).points, point) > 0 ? 1 : 0;
      }
      const auto edge = std::ranges::find(map.At(id).covisible, other, &Covisible::keyframe);
      if (edge != map.At(id).covisible.end()) {
        ASSERT_EQ(edge->shared_points, shared);
      } else if (other != id) {
        ASSERT_LT(shared, Map::kMinShared);
      }
    }
  }
}

TEST(MapValidate, SaysWhatIsWrong) {
  Random random(5);
  Map map{ScalePyramid()};
  const KeyframeId root = map.AddKeyframe(FrameId{0}, 0, {}, Data(random));
  map.AddPoint({0, 0, 2}, root, 0);
  EXPECT_THAT(map.Validate(), IsEmpty());
  const KeyframeId second = map.AddKeyframe(FrameId{1}, 1, {}, Data(random));
  EXPECT_THAT(map.Validate(), testing::ElementsAre(testing::HasSubstr("keyframe 1 hangs on 1, not on the root 0")));
  map.UpdateCovisibility(second);
  EXPECT_THAT(map.Validate(), IsEmpty());
  const_cast<Keyframe&>(map.At(root)).points[3] = PointId{0};
  EXPECT_THAT(map.Validate(), testing::ElementsAre(testing::HasSubstr("point 0 does not know that keypoint 3")));
  const_cast<Keyframe&>(map.At(root)).points[3] = PointId{};
  const_cast<MapPoint&>(map.At(PointId{0})).observations.push_back({second, 7, 0});
  EXPECT_THAT(map.Validate(), testing::ElementsAre(testing::HasSubstr("keyframe 1 does not know that its keypoint 7")));
}

}  // namespace
}  // namespace rds
