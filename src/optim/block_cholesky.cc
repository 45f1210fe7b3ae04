// SPDX-License-Identifier: Apache-2.0
#include "optim/block_cholesky.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <utility>

namespace rds {
namespace {

constexpr std::uint32_t kNoColumn = std::numeric_limits<std::uint32_t>::max();

// Of each column of the factor: that of the matrix.
std::vector<std::uint32_t> MinimumDegree(std::span<const std::vector<BlockEntry>> columns) {
  const auto size = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Triplet<float>> places;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    for (const BlockEntry& entry : columns[column]) {
      places.emplace_back(static_cast<int>(entry.row), static_cast<int>(column), 1.0F);
    }
  }
  Eigen::SparseMatrix<float> pattern(size, size);
  pattern.setFromTriplets(places.begin(), places.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
  return {order.indices().begin(), order.indices().end()};
}

}  // namespace

BlockCholesky::BlockCholesky(std::span<const std::vector<BlockEntry>> columns)
    : order_(MinimumDegree(columns)), sources_(columns.size()), start_{0}, inverse_(columns.size()) {
  std::vector<std::uint32_t> place(size());
  for (std::uint32_t i = 0; i < size(); ++i) {
    place[order_[i]] = i;
  }
  for (std::size_t column = 0; column < size(); ++column) {
    for (const auto& [row, index] : columns[column]) {
      const auto [left, right] = std::minmax(place[row], place[column]);
      sources_[left].push_back({index, right, place[row] < place[column]});
    }
  }
  // A column has the rows of its own blocks and those of its children: the columns whose first row below it is.
  std::vector<std::vector<std::uint32_t>> children(size());
  std::vector<std::uint32_t> seen(size(), kNoColumn);
  for (std::uint32_t column = 0; column < size(); ++column) {
    const auto add = [&](std::uint32_t row) {
      if (row >= column && std::exchange(seen[row], column) != column) {
        rows_.push_back(row);
      }
    };
    for (const Source& source : sources_[column]) {
      add(source.row);
    }
    for (const std::uint32_t child : children[column]) {
      for (std::size_t i = start_[child]; i < start_[child + 1]; ++i) {
        add(rows_[i]);
      }
    }
    const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(start_.back());
    std::sort(begin, rows_.end());
    start_.push_back(rows_.size());
    if (start_[column + 1] - start_[column] > 1) {
      children[rows_[start_[column] + 1]].push_back(column);
    }
  }
  factor_.resize(rows_.size());
}

bool BlockCholesky::Factorize(std::span<const Block> blocks) {
  // Columns on the left wait at the column of the next of their rows.
  std::vector<std::uint32_t> first(size(), kNoColumn);
  std::vector<std::uint32_t> next(size(), kNoColumn);
  std::vector<std::size_t> reached(size());
  std::vector<std::uint32_t> place(size());  // of a row in the present column
  const auto wait = [&](std::uint32_t column) {
    if (reached[column] < start_[column + 1]) {
      std::uint32_t& head = first[rows_[reached[column]]];
      next[column] = std::exchange(head, column);
    }
  };
  for (std::uint32_t column = 0; column < size(); ++column) {
    Block* const own = factor_.data() + start_[column];
    const auto count = static_cast<std::uint32_t>(start_[column + 1] - start_[column]);
    for (std::uint32_t i = 0; i < count; ++i) {
      own[i].setZero();
      place[rows_[start_[column] + i]] = i;
    }
    for (const auto& [index, row, transposed] : sources_[column]) {
      const Block& block = blocks[static_cast<std::size_t>(index)];
      own[place[row]] = transposed ? Block(block.transpose()) : block;
    }
    for (std::uint32_t left = first[column], after = kNoColumn; left != kNoColumn; left = after) {
      after = next[left];
      const std::size_t from = reached[left]++;
      const Block across = factor_[from].transpose();
      for (std::size_t i = from; i < start_[left + 1]; ++i) {
        own[place[rows_[i]]].noalias() -= factor_[i].lazyProduct(across);
      }
      wait(left);
    }
    const Eigen::LLT<Block> root(own[0]);
    if (root.info() != Eigen::Success) {
      return false;
    }
    own[0] = root.matrixL();
    inverse_[column] = root.matrixL().solve(Block::Identity());
    const Block inverse_transposed = inverse_[column].transpose();
    for (std::uint32_t i = 1; i < count; ++i) {
      own[i] = own[i].lazyProduct(inverse_transposed).eval();
    }
    reached[column] = start_[column] + 1;
    wait(column);
  }
  return true;
}

Eigen::VectorXd BlockCholesky::Solve(const Eigen::VectorXd& right) const {
  const auto part = [](auto& vector, std::uint32_t i) {
    return vector.template segment<6>(6 * static_cast<Eigen::Index>(i));
  };
  Eigen::VectorXd x(right.size());
  for (std::uint32_t i = 0; i < size(); ++i) {
    part(x, i) = part(right, order_[i]);
  }
  for (std::uint32_t column = 0; column < size(); ++column) {
    const Eigen::Matrix<double, 6, 1> value = inverse_[column] * part(x, column);
    part(x, column) = value;
    for (std::size_t i = start_[column] + 1; i < start_[column + 1]; ++i) {
      part(x, rows_[i]).noalias() -= factor_[i] * value;
    }
  }
  for (std::uint32_t column = static_cast<std::uint32_t>(size()); column-- > 0;) {
    Eigen::Matrix<double, 6, 1> value = part(x, column);
    for (std::size_t i = start_[column] + 1; i < start_[column + 1]; ++i) {
      value.noalias() -= factor_[i].transpose() * part(x, rows_[i]);
    }
    part(x, column) = inverse_[column].transpose() * value;
  }
  Eigen::VectorXd solution(right.size());
  for (std::uint32_t i = 0; i < size(); ++i) {
    part(solution, order_[i]) = part(x, i);
  }
  return solution;
}

}  // namespace rds
