// Moving probability of map points: the paper's section IV-D.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

#include "base/ids.h"

namespace rds {

struct MovingProbabilityOptions {
  double alpha = 0.9;          // p(labelled dynamic | dynamic)
  double beta = 0.9;           // p(labelled static | static)
  double static_below = 0.4;   // theta_s
  double dynamic_above = 0.6;  // theta_d
  double floor = 0.02;         // p stays within [floor, 1 - floor], so that a point can change its mind
};

inline constexpr double kUnknownProbability = 0.5;

enum class PointState : std::uint8_t { kStatic, kUnknown, kDynamic };

// Equation 5, with the inequality of Algorithm 2 line 10 the right way round: unknown is theta_s <= p <= theta_d.
[[nodiscard]] inline PointState StateOf(double probability, const MovingProbabilityOptions& options) {
  if (probability < options.static_below) {
    return PointState::kStatic;
  }
  return probability > options.dynamic_above ? PointState::kDynamic : PointState::kUnknown;
}

// One Bayes step (equations 2 to 4) with the proper normaliser; the transition is the identity.
[[nodiscard]] double UpdateProbability(double prior, bool observed_dynamic, const MovingProbabilityOptions& options);

// Probability of a point into which another was fused: both are independent evidence on the same prior of .5.
[[nodiscard]] double FuseProbabilities(double a, double b, const MovingProbabilityOptions& options);

// Table of probabilities by point id. Get is wait-free, from any thread, so a label helps tracking the moment it
// arrives. Set and Observe are for writers that hold the door of the map. Grows in blocks, up to 2^28 points.
class MovingProbabilities {
 public:
  MovingProbabilities() = default;
  ~MovingProbabilities();
  MovingProbabilities(const MovingProbabilities&) = delete;
  MovingProbabilities& operator=(const MovingProbabilities&) = delete;

  // .5 for points never set.
  [[nodiscard]] double Get(PointId id) const {
    const std::size_t index = id.index() / kBlock;
    const Block* block = index < blocks_.size() ? blocks_[index].load(std::memory_order_acquire) : nullptr;
    return block == nullptr ? kUnknownProbability
                            : static_cast<double>(block->values[id.index() % kBlock].load(std::memory_order_relaxed));
  }
  void Set(PointId id, double probability);
  // UpdateProbability in place.
  void Observe(PointId id, bool dynamic, const MovingProbabilityOptions& options);

 private:
  static constexpr std::size_t kBlock = 1U << 14U;
  struct Block {
    Block();
    std::array<std::atomic<float>, kBlock> values;
  };
  std::array<std::atomic<Block*>, kBlock> blocks_{};
};

}  // namespace rds
