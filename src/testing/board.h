// SPDX-License-Identifier: Apache-2.0
// Views of a board in front of a wall, for tests of what depth images say.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "testing/view.h"

namespace rds {

inline constexpr int kBoardColumns = 80;  // samples of the depth grid
inline constexpr int kBoardRows = 60;
inline constexpr float kWallDepth = 3;
inline constexpr float kBoardDepth = 1.5;

// The columns of the depth grid that the board covers, from `left` up to, not including, `right`.
struct Board {
  int left = kBoardColumns;
  int right = kBoardColumns;

  [[nodiscard]] bool Covers(int column, int row) const {
    return row >= 10 && row < 50 && column >= left && column < right;
  }
};

// A frame of TestCamera (or one like it) that sees a wall at 3 m and the board before it.
inline std::shared_ptr<const FrameData> SeeBoard(const Board& board, std::vector<Keypoint> keypoints = {},
                                                 float board_depth_m = kBoardDepth,
                                                 const PinholeCamera& camera = TestCamera()) {
  std::vector<float> depth_m;
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      depth_m.push_back(board.Covers(column, row) ? board_depth_m : kWallDepth);
    }
  }
  std::vector<Descriptor> descriptors(keypoints.size());
  return std::make_shared<const FrameData>(camera, std::move(keypoints), std::move(descriptors),
                                           DepthGrid(kBoardColumns, kBoardRows, std::move(depth_m)));
}

// The sample of a row of kBoardColumns a sample.
inline std::size_t SampleAt(int column, int row) { return static_cast<std::size_t>(row * kBoardColumns + column); }

}  // namespace rds
