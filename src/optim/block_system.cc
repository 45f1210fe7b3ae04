// SPDX-License-Identifier: Apache-2.0
#include "optim/block_system.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace rds {
namespace {

constexpr std::size_t kMaxDenseBlocks = 100;  // where the dense and the sparse solver take about as long

}  // namespace

BlockSystem::BlockSystem(std::size_t blocks) : size_(blocks), index_(blocks * blocks, -1) {
  for (std::size_t i = 0; i < size_; ++i) {
    Declare(i, i);
  }
}

void BlockSystem::Declare(std::size_t row, std::size_t column) {
  std::int32_t& index = index_[row * size_ + column];
  if (index < 0) {
    index = declared_++;
  }
}

void BlockSystem::SetZero() { blocks_.assign(static_cast<std::size_t>(declared_), Block::Zero()); }

Eigen::VectorXd BlockSystem::Solve(const Eigen::VectorXd& right) const {
  return size_ <= kMaxDenseBlocks ? SolveDense(right) : SolveSparse(right);
}

Eigen::VectorXd BlockSystem::SolveDense(const Eigen::VectorXd& right) const {
  const auto order = static_cast<Eigen::Index>(6 * size_);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
  for (std::size_t row = 0; row < size_; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      const std::int32_t index = index_[row * size_ + column];
      if (index >= 0) {
        matrix.block<6, 6>(static_cast<Eigen::Index>(6 * row), static_cast<Eigen::Index>(6 * column)) =
            blocks_[static_cast<std::size_t>(index)];
      }
    }
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(matrix);
  if (factors.info() != Eigen::Success) {
    return {};
  }
  return factors.solve(right);
}

Eigen::VectorXd BlockSystem::SolveSparse(const Eigen::VectorXd& right) const {
  const auto order = static_cast<Eigen::Index>(6 * size_);
  Eigen::SparseMatrix<double> matrix(order, order);
  matrix.reserve(36 * static_cast<Eigen::Index>(declared_));
  for (std::size_t column = 0; column < size_; ++column) {
    for (Eigen::Index j = 0; j < 6; ++j) {
      const Eigen::Index matrix_column = static_cast<Eigen::Index>(6 * column) + j;
      matrix.startVec(matrix_column);
      for (std::size_t row = column; row < size_; ++row) {
        const std::int32_t index = index_[row * size_ + column];
        if (index < 0) {
          continue;
        }
        for (Eigen::Index i = row == column ? j : 0; i < 6; ++i) {
          matrix.insertBack(static_cast<Eigen::Index>(6 * row) + i, matrix_column) =
              blocks_[static_cast<std::size_t>(index)](i, j);
        }
      }
    }
  }
  matrix.finalize();
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors(matrix);
  if (factors.info() != Eigen::Success) {
    return {};
  }
  return factors.solve(right);
}

}  // namespace rds
