// SPDX-License-Identifier: Apache-2.0
// Which keyframes look like a frame: an inverted index whose words are chosen bits of the descriptors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/ids.h"
#include "feature/frame_data.h"

namespace rds {

// How much a keyframe looks like what was asked for.
struct PlaceScore {
  KeyframeId keyframe;
  float score = 0;  // sum of the inverse document frequencies of the words that both have
};

// Bag of words (Sivic and Zisserman, ICCV 2003) without a vocabulary: a table's word for a descriptor is 16 of its
// bits, chosen to be balanced and little correlated with each other on rendered rooms, so that descriptors that differ
// by few bits share the word of some table (locality-sensitive hashing: Indyk and Motwani, 1998). Nothing is trained or
// loaded, and nothing need be stored with a map: the index is made of its keyframes' descriptors. Not thread-safe.
class PlaceIndex {
 public:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;

  PlaceIndex();

  // Indexes a keyframe by these descriptors, and by no earlier ones.
  void Add(KeyframeId keyframe, std::span<const Descriptor> descriptors);
  // Forgets a keyframe, if it is known.
  void Remove(KeyframeId keyframe);
  // The keyframes that share words with these descriptors, ascending by id. Words that a fifth of all keyframes have
  // say nothing.
  [[nodiscard]] std::vector<PlaceScore> Query(std::span<const Descriptor> descriptors) const;

  [[nodiscard]] bool Has(KeyframeId keyframe) const { return slot_of_.contains(keyframe); }
  [[nodiscard]] std::vector<KeyframeId> Keyframes() const;  // ascending
  [[nodiscard]] std::size_t size() const { return slot_of_.size(); }
  // Of the lists, bytes.
  [[nodiscard]] std::size_t Memory() const;

  // 16 bits of a descriptor.
  [[nodiscard]] static std::uint16_t Word(int table, const Descriptor& descriptor);

 private:
  using Slot = std::uint32_t;  // a keyframe as it was added once

  static std::vector<std::uint16_t> Words(int table, std::span<const Descriptor> descriptors);
  std::vector<Slot>& List(int table, std::uint16_t word) {
    return lists_[(static_cast<std::size_t>(table) << kBits) + word];
  }
  [[nodiscard]] const std::vector<Slot>& List(int table, std::uint16_t word) const {
    return lists_[(static_cast<std::size_t>(table) << kBits) + word];
  }
  // Drops the slots of what was removed from all lists.
  void Compact();

  std::vector<std::vector<Slot>> lists_;  // by table and word, ascending; those of removed keyframes may linger
  std::vector<KeyframeId> keyframe_of_;   // by slot; invalid = removed
  std::unordered_map<KeyframeId, Slot> slot_of_;
};

}  // namespace rds
