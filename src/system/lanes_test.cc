// SPDX-License-Identifier: Apache-2.0
// What happens to a keyframe and to a label, each alone, on small worlds without images.
#include "system/lanes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "segmentation/mask.h"
#include "system/trajectory_recorder.h"
#include "testing/matchers.h"
#include "testing/point_world.h"

namespace rds {
namespace {

using testing::IsEmpty;

constexpr std::uint32_t kPoints = 400;
constexpr auto kNever = [] { return false; };
constexpr auto kAlways = [] { return true; };

// Calls everything right of the middle dynamic; throws or says nothing where it is told to.
class HalfSegmenter final : public Segmenter {
 public:
  std::function<void(std::vector<Image8>&)> spoil;

  [[nodiscard]] std::vector<Image8> Segment(std::span<const SegmentationInput> inputs) override {
    std::vector<Image8> masks(inputs.size(), Image8(640, 480));
    for (Image8& mask : masks) {
      for (int y = 0; y < 480; ++y) {
        for (int x = 320; x < 640; ++x) {
          mask.At(x, y) = kDynamicPixel;
        }
      }
    }
    if (spoil) {
      spoil(masks);
    }
    return masks;
  }
  void Cancel() override {}
  [[nodiscard]] std::string Name() const override { return "half"; }
};

Rigid3 Truth(std::uint32_t frame) { return {ExpSo3({0, 0.01 * frame, 0}), {-0.05 * frame, 0, 0}}; }

struct Scene {
  PointWorld world{kPoints};
  Options options;
  std::shared_ptr<HalfSegmenter> segmenter = std::make_shared<HalfSegmenter>();
  std::shared_ptr<Lanes> lanes;

  explicit Scene(Options wanted = {}) : options(std::move(wanted)) {
    options.semantic.dilation_px = 0;
    lanes = std::make_shared<Lanes>(options, ScalePyramid{}, segmenter);
  }
  // A candidate at a pose (as tracking estimated it), with what was tracked of the map as it is.
  [[nodiscard]] KeyframeCandidate Candidate(std::uint32_t frame, const Rigid3& estimate) {
    KeyframeCandidate candidate;
    candidate.frame = FrameId{frame};
    candidate.timestamp_s = 0.1 * frame;
    const PointWorld::View view = world.Look(Truth(frame));
    candidate.data = view.data;
    candidate.points.resize(view.points.size());
    views.push_back(view);
    if (frame == 0) {
      candidate.camera_from_reference = estimate;
      return candidate;
    }
    candidate.reference = KeyframeId{0};
    lanes->backend.Read([&](const Map& map) {
      candidate.camera_from_reference = estimate * map.At(KeyframeId{0}).camera_from_world.Inverse();
      const Keyframe& first = map.At(KeyframeId{0});
      for (std::uint32_t i = 0; i < view.points.size(); ++i) {
        const auto place = std::ranges::find(views[0].points, view.points[i]);
        if (place != views[0].points.end()) {
          candidate.points[i] = first.points[static_cast<std::size_t>(place - views[0].points.begin())];
        }
      }
    });
    return candidate;
  }
  [[nodiscard]] BacklogItem Item(std::uint32_t frame, bool from_front = true) const {
    return {FrameId{frame}, 0.1 * frame, std::make_shared<const Image8>(640, 480), views.at(frame).data, from_front};
  }
  void ExpectValid() const {
    lanes->backend.Read([](const Map& map) { EXPECT_THAT(map.Validate(), IsEmpty()); });
  }
  [[nodiscard]] Rigid3 Pose(std::uint32_t keyframe) const {
    return lanes->backend.Read([&](const Map& map) { return map.At(KeyframeId{keyframe}).camera_from_world; });
  }
  std::vector<PointWorld::View> views;
};

TEST(MappingLane, ThePlaceOfAKeyframeIsPublishedAndAdjusted) {
  Scene scene;
  EXPECT_EQ(scene.lanes->backend.CurrentLocalMap(), nullptr);
  EXPECT_EQ(scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever), KeyframeId{0});
  ASSERT_NE(scene.lanes->backend.CurrentLocalMap(), nullptr);
  EXPECT_GT(scene.lanes->backend.CurrentLocalMap()->size(), 200U);
  const Rigid3 off{Truth(1).rotation, Truth(1).translation + Eigen::Vector3d(0.01, -0.01, 0.005)};
  EXPECT_EQ(scene.lanes->mapping.Map(scene.Candidate(1, off), kNever), KeyframeId{1});
  EXPECT_THAT(scene.Pose(1), RigidNear(Truth(1), 1e-3, 0.02));
  EXPECT_EQ(scene.lanes->backend.CurrentLocalMap()->keyframes.size(), 2U);
  EXPECT_EQ(scene.lanes->mapping.local_ba_ms().size(), 1U);
  scene.ExpectValid();
}

TEST(MappingLane, LeavesTheAdjustmentWhereTheNextKeyframeWaits) {
  Scene scene;
  scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kAlways);
  const Rigid3 off{Truth(1).rotation, Truth(1).translation + Eigen::Vector3d(0.01, -0.01, 0.005)};
  scene.lanes->mapping.Map(scene.Candidate(1, off), kAlways);
  EXPECT_THAT(scene.Pose(1), RigidNear(off, 1e-9, 1e-6));
  EXPECT_THAT(scene.lanes->mapping.local_ba_ms(), IsEmpty());
  scene.ExpectValid();
}

TEST(MappingLane, ALabelThatCameFirstWaitsForItsKeyframe) {
  Scene scene;
  scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
  const KeyframeCandidate next = scene.Candidate(1, Truth(1));
  std::vector<BacklogItem> items;
  items.push_back(scene.Item(1));
  scene.lanes->semantics.Apply(scene.lanes->semantics.Segment(std::move(items)));
  scene.lanes->mapping.Map(next, kNever);
  scene.lanes->backend.Read([](const Map& map) {
    EXPECT_FALSE(map.At(KeyframeId{0}).IsLabeled());
    EXPECT_TRUE(map.At(KeyframeId{1}).IsLabeled());
  });
  scene.ExpectValid();
}

TEST(SemanticLane, ALabelReachesTheProbabilitiesAndIsTold) {
  Scene scene;
  scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
  EXPECT_EQ(scene.lanes->semantics.newest_labeled(), -1);
  EXPECT_EQ(scene.lanes->semantics.NewestMask().mask, nullptr);
  scene.lanes->semantics.SetCurrentFrame(FrameId{4});
  std::vector<BacklogItem> items;
  items.push_back(scene.Item(0));
  scene.lanes->semantics.Apply(scene.lanes->semantics.Segment(std::move(items)));
  const MovingProbabilities& probabilities = scene.lanes->backend.probabilities();
  scene.lanes->backend.Read([&](const Map& map) {
    const Keyframe& keyframe = map.At(KeyframeId{0});
    for (std::size_t i = 0; i < keyframe.points.size(); ++i) {
      if (keyframe.points[i].valid()) {
        const bool right = std::lround(keyframe.data->keypoints()[i].raw_x) >= 320;
        EXPECT_EQ(probabilities.State(keyframe.points[i]), right ? PointState::kDynamic : PointState::kStatic);
      }
    }
  });
  EXPECT_EQ(scene.lanes->semantics.newest_labeled(), 0);
  EXPECT_NE(scene.lanes->semantics.NewestMask().mask, nullptr);
  EXPECT_EQ(scene.lanes->semantics.LabeledViews(0)->size(), 1U);
  const auto events = scene.lanes->semantics.events();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].labeled_frame, FrameId{0});
  EXPECT_EQ(events[0].current_frame, FrameId{4});
}

TEST(SemanticLane, CorrectsAPoseOnceItsLabelSaysWhatIsStatic) {
  for (const bool from_front : {true, false}) {
    Options options;
    options.semantic.optimizer.min_static = 30;
    Scene scene(options);
    scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
    const Rigid3 off{Truth(1).rotation, Truth(1).translation + Eigen::Vector3d(0.03, -0.02, 0.01)};
    scene.lanes->mapping.Map(scene.Candidate(1, off), kAlways);
    std::vector<BacklogItem> items;
    items.push_back(scene.Item(0, from_front));
    scene.lanes->semantics.Apply(scene.lanes->semantics.Segment(std::move(items)));
    EXPECT_THAT(scene.Pose(1), RigidNear(from_front ? Truth(1) : off, 2e-3, 0.05));
    EXPECT_EQ(scene.lanes->semantics.events().at(0).optimization_ms > 0, from_front);
    scene.ExpectValid();
  }
}

TEST(SemanticLane, CountsWhatItsBackEndDoesWrong) {
  Scene scene;
  scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
  const auto apply = [&] {
    std::vector<BacklogItem> items;
    items.push_back(scene.Item(0));
    scene.lanes->semantics.Apply(scene.lanes->semantics.Segment(std::move(items)));
    return scene.lanes->semantics.failures();
  };
  scene.segmenter->spoil = [](auto&) { throw std::runtime_error("out of order"); };
  EXPECT_EQ(apply(), 1);
  scene.segmenter->spoil = [](auto& masks) { masks.clear(); };
  EXPECT_EQ(apply(), 2);
  scene.segmenter->spoil = [](auto& masks) { masks[0] = Image8(64, 48); };
  EXPECT_EQ(apply(), 3);
  scene.segmenter->spoil = [](auto& masks) { std::ranges::fill(masks[0].data, kDynamicPixel); };
  EXPECT_EQ(apply(), 4);
  EXPECT_EQ(scene.lanes->semantics.newest_labeled(), -1);
  EXPECT_THAT(scene.lanes->semantics.events(), IsEmpty());
}

TEST(Backend, ViewsAreMadeWhereTheyAreWantedAndLocksAreTimed) {
  for (const bool wanted : {false, true}) {
    Options options;
    options.system.keep_features = wanted;
    Scene scene(options);
    EXPECT_TRUE(scene.lanes->backend.CurrentView()->points.empty());
    scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
    EXPECT_EQ(scene.lanes->backend.CurrentView()->points.empty(), !wanted);
    EXPECT_EQ(scene.lanes->backend.MakeView().keyframes.size(), 1U);
    const LockTimes times = scene.lanes->backend.lock_times();
    EXPECT_GT(times.held.count(), 5);
    EXPECT_EQ(times.held.count(), times.waited.count());
    EXPECT_EQ(times.waited_by_tracking.count(), 0);
    EXPECT_GT(times.held.max_ms(), 0);
  }
}

TEST(TrajectoryRecorder, PosesFollowTheirKeyframes) {
  Scene scene;
  TrajectoryRecorder recorder;
  TrackOutcome outcome;
  recorder.Add(FrameId{9}, 0, outcome);  // not tracked, and nothing was before
  EXPECT_EQ(recorder.lost(), 0);
  outcome.tracked = true;
  recorder.Add(FrameId{10}, 1, outcome);  // starts the world
  recorder.HangLastOn(scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever));
  outcome.reference = KeyframeId{0};
  outcome.camera_from_reference = Truth(3);
  recorder.Add(FrameId{11}, 2, outcome);
  recorder.Add(FrameId{12}, 3, {});
  EXPECT_EQ(recorder.lost(), 1);
  const Rigid3 corrected{Eigen::Quaterniond::Identity(), {0, 0, 5}};
  scene.lanes->backend.Write([&](Map& map) { map.SetPose(KeyframeId{0}, corrected); });
  const Trajectory trajectory =
      scene.lanes->backend.Read([&](const Map& map) { return recorder.Resolve(map); }).front().frames;
  ASSERT_EQ(trajectory.size(), 2U);
  EXPECT_THAT(trajectory[0].world_from_camera, RigidNear(corrected.Inverse(), 1e-9, 1e-6));
  EXPECT_THAT(trajectory[1].world_from_camera, RigidNear((Truth(3) * corrected).Inverse(), 1e-9, 1e-6));
  EXPECT_EQ(trajectory[1].timestamp_s, 2);
}

TEST(TrajectoryRecorder, AFrameThatIsFoundHangsOnWhatItLooksLike) {
  Scene scene;
  const KeyframeId first = scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
  const KeyframeId second = scene.lanes->mapping.Map(scene.Candidate(8, Truth(8)), kNever);
  TrajectoryRecorder recorder;
  TrackOutcome outcome;
  outcome.tracked = true;
  outcome.reference = first;
  recorder.AddFound(FrameId{0}, 0, first, {});  // nothing to come after yet
  recorder.Add(FrameId{1}, 0.1, outcome);
  recorder.Add(FrameId{2}, 0.2, {});
  recorder.Add(FrameId{3}, 0.3, {});
  recorder.Add(FrameId{8}, 0.8, outcome);
  const Rigid3 found{Eigen::Quaterniond::Identity(), {0, 0, -0.5}};
  recorder.AddFound(FrameId{3}, 0.3, first, found);
  EXPECT_TRUE(recorder.Has(FrameId{3}));
  EXPECT_FALSE(recorder.Has(FrameId{2}));
  EXPECT_TRUE(recorder.HasAfter(FrameId{7}));
  EXPECT_FALSE(recorder.HasAfter(FrameId{8}));
  EXPECT_EQ(recorder.found(), 1);
  EXPECT_EQ(recorder.lost(), 1);
  // What the second keyframe was corrected by is no matter of a frame that was found.
  scene.lanes->backend.Write([&](Map& map) {
    map.SetPose(first, {});
    map.SetPose(second, Rigid3{Eigen::Quaterniond::Identity(), {1, 0, -1}});
  });
  const Trajectory trajectory =
      scene.lanes->backend.Read([&](const Map& map) { return recorder.Resolve(map); }).front().frames;
  ASSERT_EQ(trajectory.size(), 3U);
  EXPECT_EQ(trajectory[1].timestamp_s, 0.3);
  EXPECT_THAT(trajectory[1].world_from_camera, RigidNear(found.Inverse(), 1e-9, 1e-6));
}

TEST(TrajectoryRecorder, FramesBeforeAKeyframeShareWhatItWasCorrectedBy) {
  Scene scene;
  const KeyframeId first = scene.lanes->mapping.Map(scene.Candidate(0, Truth(0)), kNever);
  const KeyframeId second = scene.lanes->mapping.Map(scene.Candidate(8, Truth(8)), kNever);
  const auto [start_s, end_s] = scene.lanes->backend.Read(
      [&](const Map& map) { return std::pair(map.At(first).timestamp_s, map.At(second).timestamp_s); });
  TrajectoryRecorder recorder;
  TrackOutcome outcome;
  outcome.tracked = true;
  outcome.reference = first;
  const auto add = [&](std::uint32_t frame, double share) {
    outcome.camera_from_reference = Rigid3{Eigen::Quaterniond::Identity(), {0, 0, -share}};
    recorder.Add(FrameId{frame}, start_s + share * (end_s - start_s), outcome);
  };
  add(0, 0);
  add(4, 0.5);
  add(8, 1);
  add(9, 1.1);  // tracked before the second one was there to hang on
  // Both keyframes are put where the tracker did not see them: the second one a meter to the side.
  scene.lanes->backend.Write([&](Map& map) {
    map.SetPose(first, {});
    map.SetPose(second, Rigid3{Eigen::Quaterniond::Identity(), {1, 0, -1}});
  });
  const Trajectory trajectory =
      scene.lanes->backend.Read([&](const Map& map) { return recorder.Resolve(map); }).front().frames;
  ASSERT_EQ(trajectory.size(), 4U);
  const auto place = [&](std::size_t i) { return trajectory[i].world_from_camera.translation; };
  EXPECT_THAT(place(0), MatrixNear(Eigen::Vector3d(0, 0, 0), 1e-9));
  EXPECT_THAT(place(1), MatrixNear(Eigen::Vector3d(-0.5, 0, 0.5), 1e-9));
  EXPECT_THAT(place(2), MatrixNear(Eigen::Vector3d(-1, 0, 1), 1e-9));
  EXPECT_THAT(place(3), MatrixNear(Eigen::Vector3d(-1, 0, 1.1), 1e-9));
}

}  // namespace
}  // namespace rds
