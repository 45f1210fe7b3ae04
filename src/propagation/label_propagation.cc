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

bool IsDynamic(const SurfaceLabel& label) { return label.dynamic; }

bool IsDynamic(KeypointLabel label) { return label == KeypointLabel::kDynamic; }

// What is static stays at its place; only what is dynamic is found next to it.
template <typename Label>
bool Persists(const Label& label, bool moved) {
  return !moved || IsDynamic(label);
}

// Where a grid shows the surface of a place.
struct Found {
  std::size_t sample = 0;
  bool moved = false;  // not at the place itself, but next to it: a surface that moves, or an edge
};

// The sample at the place, so that labels do not creep, else the one around it whose depth is nearest.
std::optional<Found> FindSurface(const DepthGrid& grid, const GridPlace& place) {
  const auto sample = grid.IndexWithin(place);
  if (!sample) {
    return std::nullopt;
  }
  if (SameSurface(place.depth_m, grid[*sample], depth_ratio::kSamePlace)) {
    return Found{*sample, false};
  }
  const int columns = grid.columns();
  float least_m = depth_ratio::kMovingPlace * place.depth_m;
  std::optional<Found> found;
  for (const int step : {0, -1, 1, -columns, columns, -columns - 1, -columns + 1, columns - 1, columns + 1}) {
    const std::size_t beside = *sample + static_cast<std::size_t>(step);
    if (const float off_m = std::abs(grid[beside] - place.depth_m); off_m < least_m) {
      least_m = off_m;
      found = Found{beside, true};
    }
  }
  return found;
}

// The label that a place of a later frame has by its surface; unknown if there is none.
SurfaceLabel LabelAt(const PropagatedLabels& field, const GridPlace& place) {
  const auto found = FindSurface(field.grid, place);
  const SurfaceLabel label = found ? field.labels[found->sample] : SurfaceLabel{};
  return label.IsKnown() && Persists(label, found->moved) ? label : SurfaceLabel{};
}

std::vector<SampleMotion> MarkMoving(const DepthGrid& grid, std::span<const SurfaceLabel> labels) {
  std::vector<SampleMotion> motion;
  grid.ForEach([&](int column, int row) {
    const std::size_t moving = grid.Index(column, row);
    if (labels[moving].dynamic) {
      motion.resize(labels.size());
      grid.ForEachAround(column, row, [&](int x, int y) {
        SampleMotion& here = motion[grid.Index(x, y)];
        here = std::max(here, grid.Index(x, y) == moving ? SampleMotion::kMoves : SampleMotion::kBoundary);
      });
    }
  });
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
  std::vector<std::uint8_t> result(grid.size(), 0);
  const GridWarp warp(field.camera, later_from_field.Inverse());
  const auto look_up = [&](int column, int row) {
    const std::size_t i = grid.Index(column, row);
    if (grid[i] > 0) {
      const SurfaceLabel label = LabelAt(field, warp(grid.Place(column, row)));
      result[i] = label.IsKnown() && !label.dynamic ? 1 : 0;
    }
  };
  grid.ForEach(look_up, step);
  return result;
}

std::vector<LabelPropagator::Source> LabelPropagator::FindSources(const PinholeCamera& camera, const HistoryEntry& from,
                                                                  const HistoryEntry& to) {
  std::vector<Source> sources(to.grid.size());
  const GridWarp warp(camera, from.camera_from_world * to.camera_from_world.Inverse());
  to.grid.ForEach([&](int column, int row) {
    const std::size_t i = to.grid.Index(column, row);
    if (to.grid[i] > 0) {
      if (const auto found = FindSurface(from.grid, warp(to.grid.Place(column, row)))) {
        sources[i] = {static_cast<std::int32_t>(found->sample), found->moved};
      }
    }
  });
  return sources;
}

template <typename Value>
std::vector<Value> LabelPropagator::Propagate(std::span<const Source> sources, std::span<const Value> values) {
  std::vector<Value> propagated(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].sample >= 0) {
      const Value& value = values[static_cast<std::size_t>(sources[i].sample)];
      if (Persists(value, sources[i].moved)) {
        propagated[i] = value;
      }
    }
  }
  return propagated;
}

std::vector<KeypointLabel> LabelPropagator::PropagateFrom(const DepthView& view) const {
  const auto start = std::ranges::lower_bound(history_, view.frame, {}, &HistoryEntry::frame);
  if (start == history_.end() || start->frame != view.frame || view.labels.size() != start->grid.size()) {
    return {};
  }
  std::vector<KeypointLabel> labels = view.labels;
  for (auto entry = std::next(start); entry != history_.end(); ++entry) {
    labels = Propagate<KeypointLabel>(entry->sources, labels);
  }
  return labels;
}

std::shared_ptr<const PropagatedLabels> LabelPropagator::Next(FrameId frame, const FrameData& data,
                                                              const Rigid3& camera_from_world,
                                                              std::span<const DepthView> views, std::uint32_t epoch) {
  if (std::exchange(epoch_, epoch) != epoch) {
    history_.clear();
    labels_.clear();
    propagated_.clear();
  }
  history_.push_back({frame, camera_from_world, data.depth_grid(), {}});
  HistoryEntry& now = history_.back();
  surface_.Start(now.grid);
  if (space_.enabled) {
    surface_.Add(CheckFreeSpace(data, camera_from_world, views, space_));
  }
  if (history_.size() > 1) {
    const HistoryEntry& before = history_[history_.size() - 2];
    now.sources = FindSources(data.camera(), before, now);
    surface_.Add(Propagate<SurfaceLabel>(now.sources, labels_), PenaltySince(before.frame, frame));
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
  field->epoch = epoch;
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
