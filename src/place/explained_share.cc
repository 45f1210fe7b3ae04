// SPDX-License-Identifier: Apache-2.0
#include "place/explained_share.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

constexpr int kLeastJudged = 50;  // samples
constexpr double kSigmas = 3;

}  // namespace

SurfaceAgreement CompareSurfaces(const FrameData& frame, std::span<const std::uint8_t> usable, const FrameData& view,
                                 const Rigid3& view_from_frame, int step) {
  const DepthGrid& grid = frame.depth_grid();
  const DepthGrid& seen = view.depth_grid();
  const GridWarp warp(frame.camera(), view_from_frame);
  SurfaceAgreement agreement;
  const auto judge = [&](int column, int row) {
    if (!usable.empty() && usable[grid.Index(column, row)] == 0) {
      return;
    }
    const GridPlace from = grid.Place(column, row);
    const GridPlace place = from.depth_m > 0 ? warp(from) : GridPlace{};
    if (!seen.IndexWithin(place)) {
      return;
    }
    const float tolerance_m =
        SurfaceTolerance_m(view.camera().depth_noise, place.depth_m, depth_ratio::kSamePlace, kSigmas);
    bool at_place = false;  // at an edge either surface will do
    bool beyond = true;
    seen.ForEachAround(static_cast<int>(place.column), static_cast<int>(place.row), [&](int x, int y) {
      const float depth_m = seen[seen.Index(x, y)];
      at_place = at_place || (depth_m > 0 && std::abs(depth_m - place.depth_m) <= tolerance_m);
      beyond = beyond && depth_m > place.depth_m + tolerance_m;
    });
    agreement.confirmed += at_place ? 1 : 0;
    agreement.contradicted += beyond ? 1 : 0;
  };
  grid.ForEach(judge, step);
  return agreement;
}

std::optional<double> ExplainedShare(const FrameData& frame, std::span<const std::uint8_t> usable,
                                     const FrameData& view, const Rigid3& view_from_frame) {
  const SurfaceAgreement agreement = CompareSurfaces(frame, usable, view, view_from_frame, kExplainedStep);
  return agreement.Judged() >= kLeastJudged ? std::optional(agreement.Share()) : std::nullopt;
}

}  // namespace rds
