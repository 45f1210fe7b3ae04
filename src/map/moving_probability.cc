// SPDX-License-Identifier: Apache-2.0
#include "map/moving_probability.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

// Within what a float can tell from 0 and 1.
double LogOdds(double probability) {
  const double p = std::clamp(probability, 1e-6, 1.0 - 1e-6);
  return std::log(p / (1.0 - p));
}

}  // namespace

double UpdateProbability(double prior, bool observed_dynamic, const MovingProbabilityOptions& options) {
  const double if_dynamic = observed_dynamic ? options.alpha : 1.0 - options.alpha;
  const double if_static = observed_dynamic ? 1.0 - options.beta : options.beta;
  const double posterior = if_dynamic * prior / (if_dynamic * prior + if_static * (1.0 - prior));
  return std::clamp(posterior, options.floor, 1.0 - options.floor);
}

double FuseProbabilities(double a, double b, const MovingProbabilityOptions& options) {
  const double dynamic = a * b;
  return std::clamp(dynamic / (dynamic + (1.0 - a) * (1.0 - b)), options.floor, 1.0 - options.floor);
}

MovingProbabilities::~MovingProbabilities() = default;

MovingProbabilities::Page& MovingProbabilities::PageFor(std::uint32_t number) {
  Place& place = places_[number & mask_];
  Page* page = place.page.load(std::memory_order_relaxed);
  if (page != nullptr && place.number.load(std::memory_order_relaxed) == number) {
    return *page;
  }
  if (page == nullptr) {  // else the place is taken over: the map gives a place only once all of its points are dead
    if (unused_.empty()) {
      unused_.push_back(made_.emplace_back(std::make_unique<Page>()).get());
    }
    page = unused_.back();
    unused_.pop_back();
  }
  for (auto& value : *page) {
    value.store(static_cast<float>(kUnknownProbability), std::memory_order_relaxed);
  }
  place.number.store(number, std::memory_order_relaxed);
  place.page.store(page, std::memory_order_release);
  return *page;
}

void MovingProbabilities::Set(PointId id, double probability) {
  PageFor(NumberOf(id))[id.index() % kIdsPerPage].store(static_cast<float>(probability), std::memory_order_relaxed);
}

void MovingProbabilities::Release(std::span<const std::uint32_t> page_numbers) {
  for (Dying& dying : dying_) {
    --dying.calls_left;
  }
  while (!dying_.empty() && dying_.front().calls_left <= 0) {
    Place& place = places_[dying_.front().number & mask_];
    Page* const page = place.page.load(std::memory_order_relaxed);
    if (page != nullptr && place.number.load(std::memory_order_relaxed) == dying_.front().number) {
      place.page.store(nullptr, std::memory_order_release);
      unused_.push_back(page);
    }
    dying_.pop_front();
  }
  for (const std::uint32_t number : page_numbers) {
    dying_.push_back({number});
  }
}

float MovingProbabilities::Observe(PointId id, bool dynamic) {
  const double before = Get(id);
  Set(id, UpdateProbability(before, dynamic, options_));
  return static_cast<float>(LogOdds(Get(id)) - LogOdds(before));
}

void MovingProbabilities::Retract(PointId id, float log_odds) {
  if (log_odds != 0) {
    const double odds = std::exp(LogOdds(Get(id)) - static_cast<double>(log_odds));
    Set(id, std::clamp(odds / (1.0 + odds), options_.floor, 1.0 - options_.floor));
  }
}

}  // namespace rds
