// SPDX-License-Identifier: Apache-2.0
#include "propagation/label_propagation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "map/moving_probability.h"

namespace rds {
namespace {

// Moving probability of what is dynamic for sure and of what a label just about reaches; static ones mirror them.
constexpr double kNear = 0.88;
constexpr double kFar = 0.62;
constexpr float kSameDepth = 0.03F;      // share of the depth up to which a place lies on a surface
constexpr float kTimeStepDepth = 0.06F;  // share by which the depth of what moves may change from frame to frame

bool IsDynamic(const SurfaceLabel& label) { return label.dynamic; }

bool IsDynamic(KeypointLabel label) { return label == KeypointLabel::kDynamic; }

// What is static stays at its place; only what is dynamic is found next to it.
template <typename Label>
bool IsCarried(const Label& label, bool moved) {
  return !moved || IsDynamic(label);
}

// Where a grid shows the surface of a place.
struct Found {
  std::size_t sample = 0;
  bool moved = false;  // not at the place itself, but next to it: a surface that moves, or an edge
};

// The sample at the place, so that labels do not creep, else the one around it whose depth is nearest.
std::optional<Found> FindSurface(const DepthGrid& grid, const GridPlace& place) {
  if (!(place.depth_m > 0 && place.column >= 1 && place.row >= 1 &&
        place.column < static_cast<float>(grid.columns - 1) && place.row < static_cast<float>(grid.rows - 1))) {
    return std::nullopt;
  }
  const int cell = static_cast<int>(place.row) * grid.columns + static_cast<int>(place.column);
  const auto difference_m = [&](int step) {
    return std::abs(grid.depth_m[static_cast<std::size_t>(cell + step)] - place.depth_m);
  };
  if (difference_m(0) < kSameDepth * place.depth_m) {
    return Found{static_cast<std::size_t>(cell), false};
  }
  float least_m = kTimeStepDepth * place.depth_m;
  std::optional<Found> found;
  for (const int step : {0, -1, 1, -grid.columns, grid.columns, -grid.columns - 1, -grid.columns + 1, grid.columns - 1,
                         grid.columns + 1}) {
    if (difference_m(step) < least_m) {
      least_m = difference_m(step);
      found = Found{static_cast<std::size_t>(cell + step), true};
    }
  }
  return found;
}

// The label that a place of a later frame has by its surface; unknown if there is none.
SurfaceLabel LabelAt(const PropagatedLabels& field, const GridPlace& place) {
  const auto found = FindSurface(field.grid, place);
  const SurfaceLabel label = found ? field.labels[found->sample] : SurfaceLabel{};
  return label.IsKnown() && IsCarried(label, found->moved) ? label : SurfaceLabel{};
}

std::vector<SampleMotion> MarkMoving(const DepthGrid& grid, std::span<const SurfaceLabel> labels) {
  std::vector<SampleMotion> motion;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (!labels[static_cast<std::size_t>(row * grid.columns + column)].dynamic) {
        continue;
      }
      motion.resize(labels.size());
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
          SampleMotion& here = motion[static_cast<std::size_t>(y * grid.columns + x)];
          here = std::max(here, y == row && x == column ? SampleMotion::kMoves : SampleMotion::kBoundary);
        }
      }
    }
  }
  return motion;
}

}  // namespace

KeypointProbabilities::KeypointProbabilities(std::shared_ptr<const PropagatedLabels> field,
                                             std::shared_ptr<const FrameData> later, const Rigid3& later_from_field,
                                             const SurfaceLabelOptions& options)
    : field_(std::move(field)),
      later_(std::move(later)),
      field_from_later_(field_->camera, later_from_field.Inverse()),
      options_(options) {}

double KeypointProbabilities::operator[](std::size_t keypoint) const {
  const Keypoint& here = later_->keypoints()[keypoint];
  if (!here.HasDepth()) {
    return kUnknownProbability;
  }
  const SurfaceLabel label =
      LabelAt(*field_, field_from_later_({here.raw_x / kDepthGridStep, here.raw_y / kDepthGridStep, here.depth_m}));
  if (!label.IsKnown()) {
    return kUnknownProbability;
  }
  const double p = kNear + (kFar - kNear) * label.distance_px / options_.MaxDistance(label.dynamic);
  return label.dynamic ? p : 1 - p;
}

std::vector<std::uint8_t> StaticSamples(const PropagatedLabels& field, const FrameData& later,
                                        const Rigid3& later_from_field, int step) {
  const DepthGrid& grid = later.depth_grid();
  std::vector<std::uint8_t> result(grid.depth_m.size(), 0);
  const GridWarp warp(field.camera, later_from_field.Inverse());
  for (int row = step / 2; row < grid.rows; row += step) {
    for (int column = step / 2; column < grid.columns; column += step) {
      const auto i = static_cast<std::size_t>(row * grid.columns + column);
      if (grid.depth_m[i] > 0) {
        const SurfaceLabel label =
            LabelAt(field, warp({static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F, grid.depth_m[i]}));
        result[i] = label.IsKnown() && !label.dynamic ? 1 : 0;
      }
    }
  }
  return result;
}

std::vector<LabelPropagator::Source> LabelPropagator::FindSources(const PinholeCamera& camera, const HistoryEntry& from,
                                                                  const HistoryEntry& to) {
  std::vector<Source> sources(to.grid.depth_m.size());
  const GridWarp warp(camera, from.camera_from_world * to.camera_from_world.Inverse());
  std::size_t i = 0;
  for (int row = 0; row < to.grid.rows; ++row) {
    for (int column = 0; column < to.grid.columns; ++column, ++i) {
      if (to.grid.depth_m[i] > 0) {
        const auto found = FindSurface(
            from.grid, warp({static_cast<float>(column) + 0.5F, static_cast<float>(row) + 0.5F, to.grid.depth_m[i]}));
        if (found) {
          sources[i] = {static_cast<std::int32_t>(found->sample), found->moved};
        }
      }
    }
  }
  return sources;
}

template <typename Value>
std::vector<Value> LabelPropagator::Carry(std::span<const Source> sources, std::span<const Value> values) {
  std::vector<Value> carried(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].sample >= 0) {
      const Value& value = values[static_cast<std::size_t>(sources[i].sample)];
      if (IsCarried(value, sources[i].moved)) {
        carried[i] = value;
      }
    }
  }
  return carried;
}

std::vector<KeypointLabel> LabelPropagator::PropagateFrom(const DepthView& view) const {
  const auto start = std::ranges::lower_bound(history_, view.frame, {}, &HistoryEntry::frame);
  if (start == history_.end() || start->frame != view.frame || view.labels.size() != start->grid.depth_m.size()) {
    return {};
  }
  std::vector<KeypointLabel> labels = view.labels;
  for (auto moment = std::next(start); moment != history_.end(); ++moment) {
    labels = Carry<KeypointLabel>(moment->sources, labels);
  }
  return labels;
}

std::shared_ptr<const PropagatedLabels> LabelPropagator::Next(FrameId frame, const FrameData& data,
                                                              const Rigid3& camera_from_world,
                                                              std::span<const DepthView> views) {
  history_.push_back({frame, camera_from_world, data.depth_grid(), {}});
  HistoryEntry& now = history_.back();
  surface_.Start(now.grid);
  if (space_.enabled) {
    surface_.Add(CheckFreeSpace(data, camera_from_world, views, space_));
  }
  if (history_.size() > 1) {
    const HistoryEntry& before = history_[history_.size() - 2];
    now.sources = FindSources(data.camera(), before, now);
    surface_.Add(Carry<SurfaceLabel>(now.sources, labels_), PenaltySince(before.frame, frame));
  }
  for (const DepthView& view : views) {
    if (std::ranges::find(propagated_, view.frame) == propagated_.end()) {
      surface_.Add(PropagateFrom(view), PenaltySince(view.frame, frame));
    }
  }
  propagated_.clear();
  std::ranges::transform(views, std::back_inserter(propagated_), &DepthView::frame);
  surface_.Spread();
  labels_ = surface_.Labels();
  auto field = std::make_shared<PropagatedLabels>();
  field->frame = frame;
  field->camera = data.camera();
  field->camera_from_world = camera_from_world;
  field->grid = now.grid;
  field->labels = labels_;
  field->motion = MarkMoving(now.grid, labels_);
  if (history_.size() > kLongestHistory) {
    history_.pop_front();
  }
  return field;
}

int LabelPropagator::PenaltySince(FrameId then, FrameId now) const {
  const auto frames = static_cast<int>(now.value - then.value);
  return std::min(frames, SurfaceLabel::kNone) * options_.age_penalty_px;
}

}  // namespace rds
