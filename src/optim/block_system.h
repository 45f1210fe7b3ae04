// SPDX-License-Identifier: Apache-2.0
// Symmetric linear systems of 6x6 blocks, as they remain of a bundle adjustment when the points are eliminated.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "optim/block_cholesky.h"

namespace rds {

// A symmetric positive definite matrix of n x n blocks, of which the lower ones are stored if declared. Small systems
// are factorized as dense matrices, large ones by BlockCholesky; the memory of those is that of the declared blocks and
// of those that arise. Not thread-safe.
class BlockSystem {
 public:
  using Block = BlockCholesky::Block;

  explicit BlockSystem(std::size_t blocks);

  // Declares block (row, column), row >= column. Diagonal blocks are always there. Before SetZero only.
  void Declare(std::size_t row, std::size_t column);
  // Sets all declared blocks to zero.
  void SetZero();
  // A declared block.
  Block& At(std::size_t row, std::size_t column) {
    return blocks_[static_cast<std::size_t>(size_ <= kMaxIndexed ? index_[row * size_ + column] : Find(row, column))];
  }
  // x with S x = right, right having 6 n rows; of diagonal blocks only the lower triangles are read. Empty if S is not
  // positive definite.
  [[nodiscard]] Eigen::VectorXd Solve(const Eigen::VectorXd& right);

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  static constexpr std::size_t kMaxIndexed = 600;  // blocks in a row; the index of larger systems is searched

  [[nodiscard]] std::int32_t Find(std::size_t row, std::size_t column) const;  // -1 = not declared
  [[nodiscard]] Eigen::VectorXd SolveDense(const Eigen::VectorXd& right) const;

  std::size_t size_;
  std::vector<std::int32_t> index_;               // of small systems: into blocks_, row by row; -1 = not declared
  std::vector<std::vector<BlockEntry>> columns_;  // those declared, ascending by row
  std::vector<Block> blocks_;
  std::int32_t declared_ = 0;
  std::optional<BlockCholesky> sparse_;  // keeps the ordering from one Solve to the next
};

}  // namespace rds
