// SPDX-License-Identifier: Apache-2.0
// What two depth images say of a pose between them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "feature/frame_data.h"
#include "geometry/rigid3.h"

namespace rds {

// How many samples of a depth image another view confirms, and how many it contradicts.
struct SurfaceAgreement {
  int confirmed = 0;
  int contradicted = 0;

  [[nodiscard]] int Judged() const { return confirmed + contradicted; }
  // Share, 0 to 1, of those judged that is confirmed; 0 where none is.
  [[nodiscard]] double Share() const { return Judged() > 0 ? static_cast<double>(confirmed) / Judged() : 0; }
  SurfaceAgreement& operator+=(const SurfaceAgreement& other) {
    confirmed += other.confirmed;
    contradicted += other.contradicted;
    return *this;
  }
};

// Holds every `step`-th sample of a frame's depth grid against another view of the same camera: one is confirmed where
// that view saw a surface at its place, contradicted where it looked through that place; what it could not see does not
// count. Matches may agree on the motion of a thing that fills few pixels, or on a place that only looks the same; the
// rest of the image does not. `usable` (one a sample; empty = all) marks the samples that are asked. Re-entrant.
[[nodiscard]] SurfaceAgreement CompareSurfaces(const FrameData& frame, std::span<const std::uint8_t> usable,
                                               const FrameData& view, const Rigid3& view_from_frame, int step);

inline constexpr int kExplainedStep = 2;  // samples that ExplainedShare asks: every second one in each direction

// The share that is confirmed; nothing where fewer than fifty samples can be judged.
[[nodiscard]] std::optional<double> ExplainedShare(const FrameData& frame, std::span<const std::uint8_t> usable,
                                                   const FrameData& view, const Rigid3& view_from_frame);

}  // namespace rds
