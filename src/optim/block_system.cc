// SPDX-License-Identifier: Apache-2.0
#include "optim/block_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rds {
namespace {

constexpr std::size_t kMaxDenseBlocks = 100;  // where the dense and the sparse solver take about as long

}  // namespace

BlockSystem::BlockSystem(std::size_t blocks)
    : size_(blocks), index_(blocks <= kMaxIndexed ? blocks * blocks : 0, -1), columns_(blocks) {
  for (std::size_t i = 0; i < size_; ++i) {
    Declare(i, i);
  }
}

void BlockSystem::Declare(std::size_t row, std::size_t column) {
  sparse_.reset();
  if (size_ <= kMaxIndexed) {
    std::int32_t& index = index_[row * size_ + column];
    if (index >= 0) {
      return;
    }
    index = declared_;
  }
  std::vector<BlockEntry>& entries = columns_[column];
  const auto place = std::ranges::lower_bound(entries, row, {}, &BlockEntry::row);
  if (place == entries.end() || place->row != row) {
    entries.insert(place, {static_cast<std::uint32_t>(row), declared_++});
  }
}

std::int32_t BlockSystem::Find(std::size_t row, std::size_t column) const {
  const std::vector<BlockEntry>& entries = columns_[column];
  const auto place = std::ranges::lower_bound(entries, row, {}, &BlockEntry::row);
  return place != entries.end() && place->row == row ? place->index : -1;
}

void BlockSystem::SetZero() { blocks_.assign(static_cast<std::size_t>(declared_), Block::Zero()); }

Eigen::VectorXd BlockSystem::Solve(const Eigen::VectorXd& right) {
  if (size_ <= kMaxDenseBlocks) {
    return SolveDense(right);
  }
  if (!sparse_) {
    sparse_.emplace(columns_);
  }
  return sparse_->Factorize(blocks_) ? sparse_->Solve(right) : Eigen::VectorXd();
}

Eigen::VectorXd BlockSystem::SolveDense(const Eigen::VectorXd& right) const {
  const auto order = static_cast<Eigen::Index>(6 * size_);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
  for (std::size_t column = 0; column < size_; ++column) {
    for (const BlockEntry& entry : columns_[column]) {
      matrix.block<6, 6>(static_cast<Eigen::Index>(6 * entry.row), static_cast<Eigen::Index>(6 * column)) =
          blocks_[static_cast<std::size_t>(entry.index)];
    }
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(matrix);
  if (factors.info() != Eigen::Success) {
    return {};
  }
  return factors.solve(right);
}

}  // namespace rds
