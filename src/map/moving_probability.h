// SPDX-License-Identifier: Apache-2.0
// Moving probability of map points: the paper's section IV-D.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "base/ids.h"
#include "map/id_table.h"
#include "map/map_options.h"

namespace rds {

inline constexpr double kUnknownProbability = 0.5;

enum class PointState : std::uint8_t { kStatic, kUnknown, kDynamic };

// Equation 5, with the inequality of Algorithm 2 line 10 the right way round: unknown is theta_s <= p <= theta_d.
[[nodiscard]] inline PointState StateOf(double probability, const MovingProbabilityOptions& options) {
  if (probability < options.static_below) {
    return PointState::kStatic;
  }
  return probability > options.dynamic_above ? PointState::kDynamic : PointState::kUnknown;
}

// One Bayes step (equations 2 to 4) with the proper normalizer; the transition is the identity.
[[nodiscard]] double UpdateProbability(double prior, bool observed_dynamic, const MovingProbabilityOptions& options);

// Probability of a point into which another was fused: both are independent evidence on the same prior of .5.
[[nodiscard]] double FuseProbabilities(double a, double b, const MovingProbabilityOptions& options);

// Table of probabilities by point id, in the pages of the map's ids (IdTable). Get and State are wait-free, from any
// thread, so a label helps tracking the moment it arrives. The rest is for the map.
class MovingProbabilities {
 public:
  // `pages`: as those of the map's points.
  explicit MovingProbabilities(const MovingProbabilityOptions& options = {}, std::size_t pages = kIdPages)
      : options_(options), places_(std::bit_ceil(pages)), mask_(places_.size() - 1) {}
  ~MovingProbabilities();
  MovingProbabilities(const MovingProbabilities&) = delete;
  MovingProbabilities& operator=(const MovingProbabilities&) = delete;

  // .5 for points never set, and for those whose page was released.
  [[nodiscard]] double Get(PointId id) const {
    const Place& place = places_[NumberOf(id) & mask_];
    const Page* const page = place.page.load(std::memory_order_acquire);
    return page == nullptr || place.number.load(std::memory_order_relaxed) != NumberOf(id)
               ? kUnknownProbability
               : static_cast<double>((*page)[id.index() % kIdsPerPage].load(std::memory_order_relaxed));
  }
  [[nodiscard]] PointState State(PointId id) const { return StateOf(Get(id), options_); }
  [[nodiscard]] const MovingProbabilityOptions& options() const { return options_; }

  void Set(PointId id, double probability);
  // UpdateProbability in place. Returns what that added to the log odds; Retract takes it back.
  float Observe(PointId id, bool dynamic);
  void Retract(PointId id, float log_odds);
  // Gives back pages whose points are all dead, in a while: for kPatience more calls whoever holds an old snapshot
  // still finds the values.
  void Release(std::span<const std::uint32_t> page_numbers);
  // Memory in pages, used or kept for use.
  [[nodiscard]] std::size_t pages_made() const { return made_.size(); }

  static constexpr int kPatience = 16;

 private:
  // Never destroyed before the table, for a reader may be looking: what is released serves again.
  using Page = std::array<std::atomic<float>, kIdsPerPage>;
  struct Place {
    std::atomic<Page*> page = nullptr;
    std::atomic<std::uint32_t> number = 0;  // of the page
  };
  struct Dying {
    std::uint32_t number = 0;
    int calls_left = kPatience;
  };

  static std::uint32_t NumberOf(PointId id) { return static_cast<std::uint32_t>(id.index() / kIdsPerPage); }
  [[nodiscard]] Page& PageFor(std::uint32_t number);

  MovingProbabilityOptions options_;
  std::vector<Place> places_;  // page n at n & mask_
  std::size_t mask_;
  std::vector<std::unique_ptr<Page>> made_;
  std::vector<Page*> unused_;
  std::deque<Dying> dying_;
};

}  // namespace rds
