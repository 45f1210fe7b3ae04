// SPDX-License-Identifier: Apache-2.0
#include "propagation/label_propagation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "map/moving_probability.h"
#include "testing/board.h"

namespace rds {
namespace {

constexpr int kRow = 30;  // in the middle of the board

// A mask that calls the board dynamic and the wall static.
std::vector<KeypointLabel> LabelsOf(const Board& board) {
  std::vector<KeypointLabel> labels;
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      labels.push_back(board.Covers(column, row) ? KeypointLabel::kDynamic : KeypointLabel::kStatic);
    }
  }
  return labels;
}

DepthView Labeled(std::uint32_t frame, const Board& board) {
  return MakeView(FrameId{frame}, SeeBoard(board), {}, LabelsOf(board));
}

FreeSpaceOptions NoSpace() {
  FreeSpaceOptions space;
  space.enabled = false;
  return space;
}

const SurfaceLabel& At(const PropagatedLabels& field, int column, int row = kRow) {
  return field.labels[SampleAt(column, row)];
}

bool IsDynamic(const PropagatedLabels& field, int column) {
  return At(field, column).IsKnown() && At(field, column).dynamic;
}

bool IsStatic(const PropagatedLabels& field, int column) {
  return At(field, column).IsKnown() && !At(field, column).dynamic;
}

// Shows a propagator frames of a board that moves by `step` samples a frame, from the columns 20 to 40 on; `views` come
// with the last one.
std::shared_ptr<const PropagatedLabels> Walk(LabelPropagator& propagator, std::uint32_t frames, int step,
                                             const std::vector<DepthView>& views) {
  std::shared_ptr<const PropagatedLabels> field;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const int moved = step * static_cast<int>(frame);
    const std::vector<DepthView> now = frame + 1 == frames ? views : std::vector<DepthView>{};
    field = propagator.Next(FrameId{frame}, *SeeBoard({20 + moved, 40 + moved}), {}, now);
  }
  return field;
}

TEST(LabelPropagator, NothingIsKnownBeforeTheFirstLabel) {
  LabelPropagator propagator({}, {});
  const auto field = Walk(propagator, 3, 1, {});
  EXPECT_EQ(field->frame, FrameId{2});
  EXPECT_TRUE(std::ranges::none_of(field->labels, &SurfaceLabel::IsKnown));
  EXPECT_TRUE(field->motion.empty());
}

TEST(LabelPropagator, ALabelIsAtItsPlaceInItsOwnFrame) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  EXPECT_TRUE(IsDynamic(*field, 20));
  EXPECT_TRUE(IsDynamic(*field, 39));
  EXPECT_TRUE(IsStatic(*field, 19));
  EXPECT_TRUE(IsStatic(*field, 40));
  EXPECT_EQ(At(*field, 30).distance_px, 0);
}

TEST(LabelPropagator, ALateLabelReachesThePersonWhereItIsNow) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 11, 2, {Labeled(0, {20, 40})});  // now in the columns 40 to 60
  EXPECT_TRUE(IsStatic(*field, 22));       // was covered when the label was made; the wall's own label reaches it
  EXPECT_FALSE(At(*field, 39).IsKnown());  // but not that far
  EXPECT_TRUE(IsDynamic(*field, 40));
  EXPECT_TRUE(IsDynamic(*field, 59));
  EXPECT_TRUE(IsStatic(*field, 60));
}

TEST(LabelPropagator, LabelsAreHandedOnUntilTheyAreTooFarFromTheirOrigin) {
  PropagationOptions options;
  options.age_penalty_px = 10;
  options.surface.max_static_distance_px = 50;
  LabelPropagator propagator(options, NoSpace());
  auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  const auto next = [&](std::uint32_t frame) {
    return propagator.Next(FrameId{frame}, *SeeBoard({20, 40}), {}, std::vector<DepthView>{});
  };
  field = next(1);
  EXPECT_EQ(At(*field, 10).distance_px, 10);
  field = next(4);  // frames between were lost
  EXPECT_EQ(At(*field, 10).distance_px, 40);
  EXPECT_EQ(At(*field, 30).distance_px, 40);
  field = next(5);
  EXPECT_FALSE(At(*field, 10).IsKnown());
  EXPECT_TRUE(IsDynamic(*field, 30));  // its reach is longer
  field = next(30);
  EXPECT_FALSE(At(*field, 30).IsKnown());
}

TEST(LabelPropagator, AViewIsCarriedOnce) {
  PropagationOptions options;
  options.age_penalty_px = 10;
  LabelPropagator propagator(options, NoSpace());
  const std::vector<DepthView> first{Labeled(0, {20, 40})};
  auto field = Walk(propagator, 1, 0, first);
  // Nobody says any more that the board is static; the same view, shown again, must not either.
  field = propagator.Next(FrameId{1}, *SeeBoard({20, 40}), {}, first);
  EXPECT_EQ(At(*field, 30).distance_px, 10);
}

TEST(LabelPropagator, ANewerLabelOverrulesAnOlderOne) {
  LabelPropagator propagator({}, NoSpace());
  auto field = Walk(propagator, 3, 0, {Labeled(0, {20, 40})});
  const std::vector<DepthView> views{Labeled(2, {}), Labeled(0, {20, 40})};  // the later mask misses the board
  field = propagator.Next(FrameId{3}, *SeeBoard({20, 40}), {}, views);
  EXPECT_TRUE(IsStatic(*field, 30));
}

TEST(LabelPropagator, OnlyDynamicLabelsGoWithAMovingSurface) {
  for (const bool dynamic : {true, false}) {
    LabelPropagator propagator({}, NoSpace());
    const std::vector<DepthView> views{Labeled(0, dynamic ? Board{20, 40} : Board{})};
    Walk(propagator, 1, 0, views);
    const auto field = propagator.Next(FrameId{1}, *SeeBoard({21, 41}), {}, views);
    EXPECT_EQ(At(*field, 40).dynamic, dynamic);
    // The leading edge has its own label, or one that has spread there from the sample beside it.
    const int cost_px = PropagationOptions{}.age_penalty_px;
    EXPECT_EQ(At(*field, 40).distance_px, dynamic ? cost_px : cost_px + kDepthGridStep);
  }
}

TEST(LabelPropagator, APlaceMovesWithTheCamera) {
  LabelPropagator propagator({}, NoSpace());
  Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  Rigid3 aside;
  aside.translation = {-0.24, 0, 0};  // to the right: the board shifts by ten samples to the left, the wall by five
  const auto field = propagator.Next(FrameId{1}, *SeeBoard({10, 30}), aside, std::vector<DepthView>{});
  EXPECT_TRUE(IsDynamic(*field, 10));
  EXPECT_TRUE(IsDynamic(*field, 29));
  EXPECT_TRUE(IsStatic(*field, 9));
  EXPECT_EQ(At(*field, 60).distance_px, PropagationOptions{}.age_penalty_px);
  EXPECT_TRUE(IsStatic(*field, 60));
}

TEST(LabelPropagator, AddsWhatHasMovedInThroughSpace) {
  for (const bool enabled : {true, false}) {
    FreeSpaceOptions space;
    space.enabled = enabled;
    LabelPropagator propagator({}, space);
    Walk(propagator, 1, 0, {});
    const std::vector<DepthView> views{Labeled(0, {})};  // nothing but the wall
    const auto field = propagator.Next(FrameId{1}, *SeeBoard({50, 60}), {}, views);
    EXPECT_EQ(IsDynamic(*field, 55), enabled);
  }
}

TEST(LabelPropagator, MarksWhatMovesAndTheSamplesBesideIt) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  ASSERT_EQ(field->motion.size(), field->labels.size());
  EXPECT_EQ(field->motion[SampleAt(18, kRow)], SampleMotion::kNone);
  EXPECT_EQ(field->motion[SampleAt(19, kRow)], SampleMotion::kBoundary);
  EXPECT_EQ(field->motion[SampleAt(20, kRow)], SampleMotion::kMoves);
  EXPECT_EQ(field->motion[SampleAt(30, 9)], SampleMotion::kBoundary);
  EXPECT_EQ(field->motion[SampleAt(30, 8)], SampleMotion::kNone);
  EXPECT_EQ(field->motion[SampleAt(40, kRow)], SampleMotion::kBoundary);
  EXPECT_EQ(field->motion[SampleAt(41, kRow)], SampleMotion::kNone);
}

TEST(LabelPropagator, ALabelOfAFrameItNeverSawOrForgotSaysNothing) {
  LabelPropagator propagator({}, NoSpace());
  auto field = Walk(propagator, 2, 0, {Labeled(7, {20, 40})});
  EXPECT_FALSE(At(*field, 30).IsKnown());
  field = Walk(propagator, 100, 0, {Labeled(0, {20, 40})});
  EXPECT_FALSE(At(*field, 30).IsKnown());
}

TEST(LabelPropagator, FramesWithoutADepthGridHaveNoLabels) {
  LabelPropagator propagator({}, {});
  const FrameData bare(TestCamera(), {}, {});
  Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  EXPECT_TRUE(propagator.Next(FrameId{1}, bare, {}, std::vector<DepthView>{})->labels.empty());
  const auto field = propagator.Next(FrameId{2}, *SeeBoard({20, 40}), {}, std::vector<DepthView>{});
  EXPECT_FALSE(At(*field, 30).IsKnown());
}

// A keypoint in the middle of a sample.
Keypoint KeypointAt(int column, int row, float depth_m) {
  Keypoint keypoint;
  keypoint.raw_x = keypoint.x = static_cast<float>(column * kDepthGridStep + kDepthGridStep / 2);
  keypoint.raw_y = keypoint.y = static_cast<float>(row * kDepthGridStep + kDepthGridStep / 2);
  keypoint.depth_m = depth_m;
  return keypoint;
}

TEST(KeypointProbabilities, AreThoseOfTheSurfaceThatTheKeypointLiesOn) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  const auto later = SeeBoard({}, {KeypointAt(30, kRow, kBoardDepth),           // on the board
                                   KeypointAt(40, kRow, kBoardDepth),           // it has moved on a little
                                   KeypointAt(50, kRow, kBoardDepth),           // too far for that
                                   KeypointAt(50, kRow, kWallDepth),            // on the wall
                                   KeypointAt(30, kRow, 0),                     // no depth
                                   KeypointAt(30, kRow, 1.05F * kBoardDepth),   // it has moved away a little
                                   KeypointAt(60, kRow, 0.95F * kWallDepth)});  // walls do not: this is something else
  const KeypointProbabilities p(field, later, {}, {});
  EXPECT_DOUBLE_EQ(p[0], 0.88);
  EXPECT_DOUBLE_EQ(p[1], 0.88);
  EXPECT_DOUBLE_EQ(p[2], kUnknownProbability);
  EXPECT_DOUBLE_EQ(p[3], 1 - 0.88);
  EXPECT_DOUBLE_EQ(p[4], kUnknownProbability);
  EXPECT_DOUBLE_EQ(p[5], 0.88);
  EXPECT_DOUBLE_EQ(p[6], kUnknownProbability);
}

TEST(KeypointProbabilities, FadeWithTheDistanceOfTheLabel) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  const auto later = SeeBoard({}, {KeypointAt(30, kRow, kBoardDepth), KeypointAt(60, kRow, kWallDepth)});
  double dynamic = KeypointProbabilities(field, later, {}, {})[0];
  double fixed = KeypointProbabilities(field, later, {}, {})[1];
  for (const std::uint32_t frame : {5U, 10U, 15U, 20U}) {
    const auto handed_on = propagator.Next(FrameId{frame}, *SeeBoard({20, 40}), {}, std::vector<DepthView>{});
    const KeypointProbabilities p(handed_on, later, {}, {});
    EXPECT_LT(p[0], dynamic);
    EXPECT_GT(p[1], fixed);
    EXPECT_EQ(StateOf(p[0], {}), PointState::kDynamic);
    EXPECT_EQ(StateOf(p[1], {}), PointState::kStatic);
    dynamic = p[0];
    fixed = p[1];
  }
}

TEST(KeypointProbabilities, LookWhereTheCameraHasMovedTo) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  Rigid3 later_from_field;
  later_from_field.translation = {-0.24, 0, 0};  // the board is ten samples to the left now
  const auto later = SeeBoard({}, {KeypointAt(12, kRow, kBoardDepth), KeypointAt(35, kRow, kBoardDepth)});
  const KeypointProbabilities p(field, later, later_from_field, {});
  EXPECT_DOUBLE_EQ(p[0], 0.88);
  EXPECT_DOUBLE_EQ(p[1], kUnknownProbability);
}

TEST(StaticSamples, AreThoseOfSurfacesThatKeepStill) {
  LabelPropagator propagator({}, NoSpace());
  const auto field = Walk(propagator, 1, 0, {Labeled(0, {20, 40})});
  const std::vector<std::uint8_t> still = StaticSamples(*field, *SeeBoard({20, 40}), {}, 2);
  ASSERT_EQ(still.size(), SampleAt(0, kBoardRows));
  EXPECT_EQ(still[SampleAt(61, 31)], 1);  // the wall
  EXPECT_EQ(still[SampleAt(31, 31)], 0);  // the board
  EXPECT_EQ(still[SampleAt(60, 31)], 0);  // not asked for
  EXPECT_EQ(still[SampleAt(61, 30)], 0);
  // Without a label nothing is known to keep still.
  LabelPropagator unlabeled({}, NoSpace());
  const std::vector<std::uint8_t> none = StaticSamples(*Walk(unlabeled, 1, 0, {}), *SeeBoard({20, 40}), {}, 1);
  EXPECT_EQ(std::ranges::count(none, 1), 0);
}

// A loop was closed: what was propagated lies where the map was.
TEST(LabelPropagator, BeginsAnewWithPosesOfAnotherEpoch) {
  LabelPropagator propagator({}, NoSpace());
  EXPECT_TRUE(IsDynamic(*Walk(propagator, 2, 0, {Labeled(0, {20, 40})}), 30));
  const auto field = propagator.Next(FrameId{2}, *SeeBoard({20, 40}), {}, std::vector<DepthView>{}, 1);
  EXPECT_EQ(field->epoch, 1U);
  EXPECT_FALSE(At(*field, 30).IsKnown());
}

}  // namespace
}  // namespace rds
