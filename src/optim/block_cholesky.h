// SPDX-License-Identifier: Apache-2.0
// Cholesky factorization of sparse symmetric matrices of 6x6 blocks.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rds {

// Where a block lies in its column, and in an array of blocks.
struct BlockEntry {
  std::uint32_t row = 0;
  std::int32_t index = 0;
};

// The matrix is ordered so that few new blocks arise (minimum degree); its factor L is found column by column from the
// columns on the left (Davis, "Direct methods for sparse linear systems", 2006, chapters 4 and 7). That blocks and not
// numbers are gone through is what makes it several times as fast as Eigen's solver. Not thread-safe.
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, 6, 6>;

  // Orders a matrix. `columns`: the blocks of each from the diagonal down, ascending by row, the diagonal's among them.
  explicit BlockCholesky(std::span<const std::vector<BlockEntry>> columns);

  // Of diagonal blocks only the lower triangles are read. Whether the matrix is positive definite.
  [[nodiscard]] bool Factorize(std::span<const Block> blocks);
  // x with L L^T x = right, once factorized.
  [[nodiscard]] Eigen::VectorXd Solve(const Eigen::VectorXd& right) const;

 private:
  // A block of the matrix and where it goes in L.
  struct Source {
    std::int32_t index = 0;
    std::uint32_t row = 0;
    bool transposed = false;
  };

  [[nodiscard]] std::size_t size() const { return order_.size(); }

  std::vector<std::uint32_t> order_;          // of each column of L: that of the matrix
  std::vector<std::vector<Source>> sources_;  // of each column of L
  std::vector<std::uint32_t> rows_;           // of L's blocks, column by column, ascending, the diagonal first
  std::vector<std::size_t> start_;            // of each column in them, and the end
  std::vector<Block> factor_;
  std::vector<Block> inverse_;  // of the factor's diagonal blocks
};

}  // namespace rds
