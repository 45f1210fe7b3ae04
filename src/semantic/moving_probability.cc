#include "semantic/moving_probability.h"

#include <algorithm>

#include "base/error.h"

namespace rds {

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

MovingProbabilities::Block::Block() {
  for (auto& value : values) {
    value.store(static_cast<float>(kUnknownProbability), std::memory_order_relaxed);
  }
}

MovingProbabilities::~MovingProbabilities() {
  for (auto& block : blocks_) {
    delete block.load(std::memory_order_relaxed);
  }
}

void MovingProbabilities::Set(PointId id, double probability) {
  const std::size_t index = id.index() / kBlock;
  Check(index < blocks_.size(), "point ids stay below 2^28");
  Block* block = blocks_[index].load(std::memory_order_relaxed);
  if (block == nullptr) {
    block = new Block();
    blocks_[index].store(block, std::memory_order_release);
  }
  block->values[id.index() % kBlock].store(static_cast<float>(probability), std::memory_order_relaxed);
}

void MovingProbabilities::Observe(PointId id, bool dynamic, const MovingProbabilityOptions& options) {
  Set(id, UpdateProbability(Get(id), dynamic, options));
}

}  // namespace rds
