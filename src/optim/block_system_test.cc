// SPDX-License-Identifier: Apache-2.0
#include "optim/block_system.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "base/random.h"

namespace rds {
namespace {

// A band and some far blocks, diagonally dominant. Writes the same matrix to both.
Eigen::MatrixXd Fill(std::size_t size, BlockSystem* system) {
  Random random(size);
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::size_t row = 0; row < size; ++row) {
    for (std::size_t column = 0; column < row; ++column) {
      if (row - column < 4 || (row * column) % 97 == 5) {
        system->Declare(row, column);
        places.emplace_back(row, column);
      }
    }
  }
  system->SetZero();
  const auto order = static_cast<Eigen::Index>(6 * size);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
  for (const auto& [row, column] : places) {
    BlockSystem::Block& block = system->At(row, column);
    for (double& value : block.reshaped()) {
      value = random.Uniform(-1, 1);
    }
    matrix.block<6, 6>(static_cast<Eigen::Index>(6 * row), static_cast<Eigen::Index>(6 * column)) = block;
  }
  for (std::size_t i = 0; i < size; ++i) {
    BlockSystem::Block& block = system->At(i, i);
    block.diagonal().setConstant(150);
    block(4, 1) = 7;
    block(1, 4) = 1e9;  // above the diagonal: must not be read
    matrix.block<6, 6>(static_cast<Eigen::Index>(6 * i), static_cast<Eigen::Index>(6 * i)) =
        block.triangularView<Eigen::Lower>();
  }
  return matrix.selfadjointView<Eigen::Lower>();
}

TEST(BlockSystem, SolvesLikeADenseMatrixSmallAndLarge) {
  for (const std::size_t size : {1U, 5U, 40U, 130U, 700U}) {
    BlockSystem system(size);
    const Eigen::MatrixXd matrix = Fill(size, &system);
    const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 2);
    const Eigen::VectorXd solution = system.Solve(matrix * expected);
    ASSERT_EQ(solution.size(), expected.size());
    EXPECT_LT((solution - expected).norm(), 1e-9 * expected.norm()) << size;
  }
}

TEST(BlockSystem, SaysSoIfNotPositiveDefinite) {
  for (const std::size_t size : {2U, 130U, 700U}) {
    BlockSystem system(size);
    Fill(size, &system);
    system.At(1, 1)(3, 3) = -150;
    EXPECT_EQ(system.Solve(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(6 * size))).size(), 0);
  }
}

// Loops that nothing connects, of a size that is solved as a sparse one; twice, with other numbers the second time.
TEST(BlockSystem, SolvesWhatFallsApart) {
  constexpr std::size_t kSize = 150;
  constexpr std::size_t kLoop = 15;
  BlockSystem system(kSize);
  std::vector<std::pair<std::size_t, std::size_t>> places;  // row, column
  for (std::size_t i = 0; i < kSize; ++i) {
    const bool is_last = i % kLoop == kLoop - 1;
    const auto [row, column] = places.emplace_back(is_last ? i : i + 1, is_last ? i + 1 - kLoop : i);
    system.Declare(row, column);
  }
  Random random(7);
  for (int round = 0; round < 2; ++round) {
    system.SetZero();
    const auto order = static_cast<Eigen::Index>(6 * kSize);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
    for (std::size_t i = 0; i < kSize; ++i) {
      system.At(i, i).diagonal().setConstant(20);
    }
    for (const auto& [row, column] : places) {
      BlockSystem::Block& block = system.At(row, column);
      for (double& value : block.reshaped()) {
        value = random.Uniform(-1, 1);
      }
      matrix.block<6, 6>(static_cast<Eigen::Index>(6 * row), static_cast<Eigen::Index>(6 * column)) = block;
    }
    matrix.diagonal().setConstant(20);
    const Eigen::MatrixXd whole = matrix.selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(order, -1, 2);
    const Eigen::VectorXd solution = system.Solve(whole * expected);
    ASSERT_EQ(solution.size(), expected.size());
    EXPECT_LT((solution - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(BlockSystem, CanBeFilledAnew) {
  BlockSystem system(3);
  Fill(3, &system);
  system.SetZero();
  for (std::size_t i = 0; i < 3; ++i) {
    system.At(i, i).diagonal().setConstant(2);
  }
  EXPECT_TRUE(system.Solve(Eigen::VectorXd::Ones(18)).isApprox(Eigen::VectorXd::Constant(18, 0.5)));
}

}  // namespace
}  // namespace rds
