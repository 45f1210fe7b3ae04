#include "tracking/feature_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"

namespace rds {
namespace {

constexpr float kWallDepth = 3;
constexpr float kPersonDepth = 1.2F;

PinholeCamera Camera() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  return camera;
}

// A wall with a person before it: features at every 40 px, each with a descriptor of its own. The wall moves by
// `wall_x` pixels, the person, 160 px wide, by `person_x`.
struct Scene {
  std::shared_ptr<const FrameData> frame;
  std::vector<bool> on_person;  // of each keypoint
};

Scene MakeScene(float wall_x, float person_x, int without_descriptors_of = -1, float person_depth = kPersonDepth) {
  Random random(7);
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  Scene scene;
  const auto on_person = [&](float x) { return x >= 200 + person_x && x < 360 + person_x; };
  for (const bool person : {false, true}) {
    for (float y = 24; y < 480; y += 40) {
      for (float x = 20; x < 640; x += 40) {
        Descriptor descriptor;
        for (auto& word : descriptor) {
          word = random.Bits();
        }
        const bool here = person ? x >= 200 && x < 360 : true;
        Keypoint keypoint;
        keypoint.x = x + (person ? person_x : wall_x);
        keypoint.y = y;
        keypoint.raw_x = keypoint.x;
        keypoint.raw_y = keypoint.y;
        keypoint.depth_m = person ? person_depth : kWallDepth;
        if (!here || keypoint.x >= 640 || (!person && on_person(keypoint.x))) {
          continue;
        }
        if (static_cast<int>(person) == without_descriptors_of) {
          descriptor = {};
          descriptor[keypoints.size() % 4] = ~std::uint64_t{0} >> (keypoints.size() % 64);
        }
        keypoints.push_back(keypoint);
        descriptors.push_back(descriptor);
        scene.on_person.push_back(person);
      }
    }
  }
  DepthGrid grid{640 / kDepthGridStep, 480 / kDepthGridStep, {}};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      grid.depth_m.push_back(on_person(static_cast<float>(column * kDepthGridStep + 4)) ? person_depth : kWallDepth);
    }
  }
  scene.frame = std::make_shared<const FrameData>(Camera(), keypoints, descriptors, grid);
  return scene;
}

// Labels all tracks as a mask of the person would.
void Label(const Scene& scene, const KeypointLabels& labels, MovingProbabilities& table) {
  for (std::size_t i = 0; i < labels.tracks.size(); ++i) {
    if (labels.tracks[i].valid()) {
      table.Observe(labels.tracks[i], scene.on_person[i], {});
    }
  }
}

int Count(const KeypointLabels& labels, const Scene& scene, bool person, PointState state) {
  int count = 0;
  for (std::size_t i = 0; i < scene.on_person.size(); ++i) {
    count += scene.on_person[i] == person && StateOf(labels.probabilities[i], {}) == state ? 1 : 0;
  }
  return count;
}

int CountPerson(const Scene& scene) {
  return static_cast<int>(std::count(scene.on_person.begin(), scene.on_person.end(), true));
}

TEST(FeatureTracksTest, NothingIsKnownBeforeTheFirstLabel) {
  FeatureTracks tracks({});
  MovingProbabilities table;
  const Scene scene = MakeScene(0, 0);
  const KeypointLabels labels = tracks.Follow(scene.frame, {}, table, {});
  ASSERT_EQ(labels.tracks.size(), scene.frame->size());
  for (const double p : labels.probabilities) {
    EXPECT_EQ(p, kUnknownProbability);
  }
}

TEST(FeatureTracksTest, ALateLabelReachesThePersonWhereItIsNow) {
  FeatureTracks tracks({});
  MovingProbabilities table;
  const Scene first = MakeScene(0, 0);
  const KeypointLabels at_first = tracks.Follow(first.frame, {}, table, {});
  Scene scene;
  KeypointLabels labels;
  for (int step = 1; step <= 8; ++step) {
    scene = MakeScene(static_cast<float>(-2 * step), static_cast<float>(10 * step));
    labels = tracks.Follow(scene.frame, {}, table, {});
  }
  EXPECT_EQ(Count(labels, scene, true, PointState::kUnknown), CountPerson(scene));
  Label(first, at_first, table);  // eight frames late
  scene = MakeScene(-18, 90);
  labels = tracks.Follow(scene.frame, {}, table, {});
  EXPECT_EQ(Count(labels, scene, true, PointState::kDynamic), CountPerson(scene));
  EXPECT_EQ(Count(labels, scene, false, PointState::kDynamic), 0);
}

TEST(FeatureTracksTest, ALabelOutlivesTheTracksThatBroughtIt) {
  FeatureTrackOptions options;
  options.surface.dynamic_reach_px = 100;
  FeatureTracks tracks(options);
  MovingProbabilities table;
  Scene scene = MakeScene(0, 0);
  KeypointLabels labels = tracks.Follow(scene.frame, {}, table, {});
  // Half of the person's features get the label; its neighbours inherit it.
  int left_out = 0;
  for (std::size_t i = 0; i < labels.tracks.size(); ++i) {
    if (scene.on_person[i] && i % 2 == 0) {
      ++left_out;
    } else {
      table.Observe(labels.tracks[i], scene.on_person[i], {});
    }
  }
  ASSERT_GT(left_out, 10);
  scene = MakeScene(0, 5);
  labels = tracks.Follow(scene.frame, {}, table, {});
  EXPECT_EQ(Count(labels, scene, true, PointState::kDynamic), CountPerson(scene));
  // The table forgets every track: what was inherited still counts for a while, then is too old.
  for (std::size_t i = 0; i < labels.tracks.size(); ++i) {
    table.Set(labels.tracks[i], kUnknownProbability);
  }
  scene = MakeScene(0, 10);
  labels = tracks.Follow(scene.frame, {}, table, {});
  EXPECT_EQ(Count(labels, scene, true, PointState::kDynamic), CountPerson(scene));
  for (int step = 3; step < 40; ++step) {
    scene = MakeScene(0, static_cast<float>(5 * step));
    labels = tracks.Follow(scene.frame, {}, table, {});
  }
  EXPECT_EQ(Count(labels, scene, true, PointState::kDynamic), 0);
}

TEST(FeatureTracksTest, ATrackThatIsNotFoundStartsAnewWithoutALabel) {
  FeatureTrackOptions options;
  options.surface.dynamic_reach_px = 1;
  options.surface.static_reach_px = 1;
  FeatureTracks tracks(options);
  MovingProbabilities table;
  const Scene first = MakeScene(0, 0);
  const KeypointLabels at_first = tracks.Follow(first.frame, {}, table, {});
  Label(first, at_first, table);
  const Scene scene = MakeScene(0, 0, 1);  // the person has turned round
  const KeypointLabels labels = tracks.Follow(scene.frame, {}, table, {});
  EXPECT_EQ(Count(labels, scene, true, PointState::kUnknown), CountPerson(scene));
  EXPECT_EQ(Count(labels, scene, false, PointState::kStatic),
            static_cast<int>(scene.frame->size()) - CountPerson(scene));
}

TEST(FeatureTracksTest, ATrackDoesNotJumpInDepth) {
  FeatureTrackOptions options;
  options.surface.dynamic_reach_px = 1;
  options.surface.static_reach_px = 1;
  const auto dynamic_at = [&](float depth_m) {
    FeatureTracks tracks(options);
    MovingProbabilities table;
    const Scene first = MakeScene(0, 0);
    Label(first, tracks.Follow(first.frame, {}, table, {}), table);
    const Scene scene = MakeScene(0, 0, -1, depth_m);
    return Count(tracks.Follow(scene.frame, {}, table, {}), scene, true, PointState::kDynamic);
  };
  EXPECT_EQ(dynamic_at(1.05F * kPersonDepth), CountPerson(MakeScene(0, 0)));
  EXPECT_EQ(dynamic_at(1.5F * kPersonDepth), 0);
  EXPECT_EQ(dynamic_at(0), CountPerson(MakeScene(0, 0)));  // without depth, appearance decides
}

TEST(FeatureTracksTest, TracksKeepTheirDistance) {
  FeatureTrackOptions options;
  options.spacing_px = 80;
  FeatureTracks tracks(options);
  MovingProbabilities table;
  const Scene scene = MakeScene(0, 0);
  const KeypointLabels labels = tracks.Follow(scene.frame, {}, table, {});
  const auto count = std::count_if(labels.tracks.begin(), labels.tracks.end(), [](PointId id) { return id.valid(); });
  EXPECT_GE(count, 48);
  EXPECT_LT(count, static_cast<std::ptrdiff_t>(scene.frame->size()) / 2);
}

}  // namespace
}  // namespace rds
