// SPDX-License-Identifier: Apache-2.0
#include "optim/block_system.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

namespace rds {
namespace {

constexpr std::size_t kMaxDenseBlocks = 100;  // where the dense and the sparse solver take about as long
// With many blocks declared, the factors of a sparse matrix are dense, and the sparse solver is the slower one.
constexpr std::size_t kMaxDenserBlocks = 600;
constexpr double kDense = 0.2;  // share of all blocks

}  // namespace

struct BlockSystem::SparseFactors {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
};

BlockSystem::~BlockSystem() = default;
BlockSystem::BlockSystem(BlockSystem&&) noexcept = default;
BlockSystem& BlockSystem::operator=(BlockSystem&&) noexcept = default;

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
  std::vector<Entry>& entries = columns_[column];
  const auto place = std::ranges::lower_bound(entries, row, {}, &Entry::row);
  if (place == entries.end() || place->row != row) {
    entries.insert(place, {static_cast<std::uint32_t>(row), declared_++});
  }
}

std::int32_t BlockSystem::Find(std::size_t row, std::size_t column) const {
  const std::vector<Entry>& entries = columns_[column];
  const auto place = std::ranges::lower_bound(entries, row, {}, &Entry::row);
  return place != entries.end() && place->row == row ? place->index : -1;
}

void BlockSystem::SetZero() { blocks_.assign(static_cast<std::size_t>(declared_), Block::Zero()); }

Eigen::VectorXd BlockSystem::Solve(const Eigen::VectorXd& right) {
  const double all = 0.5 * static_cast<double>(size_) * static_cast<double>(size_ + 1);
  const bool is_dense =
      size_ <= kMaxDenseBlocks || (size_ <= kMaxDenserBlocks && static_cast<double>(declared_) > kDense * all);
  return is_dense ? SolveDense(right) : SolveSparse(right);
}

Eigen::VectorXd BlockSystem::SolveDense(const Eigen::VectorXd& right) const {
  const auto order = static_cast<Eigen::Index>(6 * size_);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
  for (std::size_t column = 0; column < size_; ++column) {
    for (const Entry& entry : columns_[column]) {
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

Eigen::VectorXd BlockSystem::SolveSparse(const Eigen::VectorXd& right) {
  const auto order = static_cast<Eigen::Index>(6 * size_);
  Eigen::SparseMatrix<double> matrix(order, order);
  matrix.reserve(36 * static_cast<Eigen::Index>(declared_));
  for (std::size_t column = 0; column < size_; ++column) {
    for (Eigen::Index j = 0; j < 6; ++j) {
      const Eigen::Index matrix_column = static_cast<Eigen::Index>(6 * column) + j;
      matrix.startVec(matrix_column);
      for (const Entry& entry : columns_[column]) {
        for (Eigen::Index i = entry.row == column ? j : 0; i < 6; ++i) {
          matrix.insertBack(static_cast<Eigen::Index>(6 * entry.row) + i, matrix_column) =
              blocks_[static_cast<std::size_t>(entry.index)](i, j);
        }
      }
    }
  }
  matrix.finalize();
  if (sparse_ == nullptr) {
    sparse_ = std::make_unique<SparseFactors>();
    sparse_->solver.analyzePattern(matrix);
  }
  sparse_->solver.factorize(matrix);
  if (sparse_->solver.info() != Eigen::Success) {
    return {};
  }
  return sparse_->solver.solve(right);
}

}  // namespace rds
