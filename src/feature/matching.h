// SPDX-License-Identifier: Apache-2.0
// Descriptor matching: thresholds, best candidate in a window, rotation check.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "feature/frame_data.h"

namespace rds {

// Largest Hamming distances of matches: strict where nothing else confirms a match (by appearance alone, between
// keyframes), loose within a window around a projection. Descriptors of unrelated corners differ by 128 bits on average
// (256 fair coins, standard deviation 8). The values are conventions of the ORB-SLAM family, not tuned here.
inline constexpr int kStrictDistance = 50;
inline constexpr int kLooseDistance = 100;

// A keypoint that takes a query (a projected point, or a keypoint of another frame).
struct Match {
  std::uint32_t query = 0;
  std::uint32_t keypoint = 0;
  int distance = 0;  // Hamming
};

// Where to look for a query in a frame.
struct SearchWindow {
  float x = 0;  // undistorted pixel
  float y = 0;
  float depth_m = 0;  // predicted; what has depth must agree with it roughly; 0 = do not check
  float radius_px = 0;
  int min_octave = 0;
  int max_octave = std::numeric_limits<std::uint8_t>::max();
};

// Best and second best candidate of a window.
struct Candidate {
  int keypoint = -1;  // -1 = none
  int distance = 257;
  int octave = -1;
  int second_distance = 257;
  int second_octave = -1;

  // Lowe's ratio test, between candidates of the same octave only.
  [[nodiscard]] bool IsDistinct(double ratio) const {
    return octave != second_octave || distance <= ratio * second_distance;
  }
};

[[nodiscard]] Candidate FindBest(const FrameData& frame, const SearchWindow& window, const Descriptor& descriptor);

// Collects matches so that a keypoint is taken by the closest query only, whatever the order. Not thread-safe.
class MatchSet {
 public:
  explicit MatchSet(std::size_t keypoints) : best_(keypoints, kFree) {}

  void Add(const Match& match);
  [[nodiscard]] std::vector<Match> Take() const;  // ascending by keypoint

 private:
  static constexpr std::uint64_t kFree = std::numeric_limits<std::uint64_t>::max();
  std::vector<std::uint64_t> best_;  // distance in the high half, query in the low half: the least one wins
};

// Removes matches whose rotation (query angle minus keypoint angle) is not in one of the three fullest of 30 bins.
// query_angles_deg[match.query] is the query's orientation.
void KeepConsistentRotation(const FrameData& frame, std::span<const float> query_angles_deg,
                            std::vector<Match>* matches);

// Brute force matching of chosen keypoints of `a` (queries: index into `chosen`) to all keypoints of `b`: closest with
// ratio test, strict threshold, rotation check, each keypoint of b once.
[[nodiscard]] std::vector<Match> MatchDescriptors(const FrameData& a, std::span<const std::uint32_t> chosen,
                                                  const FrameData& b, double ratio);

}  // namespace rds
