// SPDX-License-Identifier: Apache-2.0
#include "feature/matching.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

constexpr float kOtherDepth = 0.2F;  // of the expected one: what is so far off is another thing

}  // namespace

Candidate FindBest(const FrameData& frame, const SearchWindow& window, const Descriptor& descriptor) {
  Candidate best;
  const auto descriptors = frame.descriptors();
  frame.ForEachInWindow(window.x, window.y, window.radius_px, window.min_octave, window.max_octave,
                        [&](const FrameData::GridItem& item) {
                          if (window.depth_m > 0 && item.depth_m > 0 &&
                              std::abs(window.depth_m - item.depth_m) > kOtherDepth * window.depth_m) {
                            return;
                          }
                          const int distance = HammingDistance(descriptor, descriptors[item.index]);
                          if (distance < best.distance) {
                            best.second_distance = best.distance;
                            best.second_octave = best.octave;
                            best.distance = distance;
                            best.octave = item.octave;
                            best.keypoint = item.index;
                          } else if (distance < best.second_distance) {
                            best.second_distance = distance;
                            best.second_octave = item.octave;
                          }
                        });
  return best;
}

void MatchSet::Add(const Match& match) {
  const std::uint64_t key = (static_cast<std::uint64_t>(match.distance) << 32) | match.query;
  best_[match.keypoint] = std::min(best_[match.keypoint], key);
}

std::vector<Match> MatchSet::Take() const {
  std::vector<Match> matches;
  for (std::size_t i = 0; i < best_.size(); ++i) {
    if (best_[i] != kFree) {
      matches.push_back(
          {static_cast<std::uint32_t>(best_[i]), static_cast<std::uint32_t>(i), static_cast<int>(best_[i] >> 32)});
    }
  }
  return matches;
}

void KeepConsistentRotation(const FrameData& frame, std::span<const float> query_angles_deg,
                            std::vector<Match>* matches) {
  constexpr int kBins = 30;
  std::array<int, kBins> histogram{};
  const auto bin_of = [&](const Match& match) {
    float turn = query_angles_deg[match.query] - frame.keypoints()[match.keypoint].angle_deg;
    turn = turn < 0 ? turn + 360.0F : turn;
    return static_cast<std::size_t>(turn * (kBins / 360.0F) + 0.5F) % kBins;
  };
  for (const Match& match : *matches) {
    ++histogram[bin_of(match)];
  }
  std::array<int, kBins> order = histogram;
  std::ranges::sort(order, std::greater<>());
  // Second and third bin count only if they hold at least a tenth of the fullest.
  int least = order[0];
  for (const int count : {order[1], order[2]}) {
    least = 10 * count >= order[0] ? count : least;
  }
  std::erase_if(*matches, [&](const Match& match) { return histogram[bin_of(match)] < std::max(least, 1); });
}

std::vector<Match> MatchDescriptors(const FrameData& a, std::span<const std::uint32_t> chosen, const FrameData& b,
                                    double ratio) {
  MatchSet set(b.size());
  std::vector<float> angles;
  const auto candidates = b.descriptors();
  for (std::size_t query = 0; query < chosen.size(); ++query) {
    angles.push_back(a.keypoints()[chosen[query]].angle_deg);
    const Descriptor& descriptor = a.descriptors()[chosen[query]];
    int best = 257;
    int second = 257;
    std::size_t keypoint = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const int distance = HammingDistance(descriptor, candidates[i]);
      if (distance < best) {
        second = best;
        best = distance;
        keypoint = i;
      } else {
        second = std::min(second, distance);
      }
    }
    if (best <= kStrictDistance && best <= ratio * second) {
      set.Add({static_cast<std::uint32_t>(query), static_cast<std::uint32_t>(keypoint), best});
    }
  }
  std::vector<Match> matches = set.Take();
  KeepConsistentRotation(b, angles, &matches);
  return matches;
}

}  // namespace rds
