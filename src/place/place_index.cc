// SPDX-License-Identifier: Apache-2.0
#include "place/place_index.h"

#include <algorithm>
#include <cmath>

namespace rds {
namespace {

// Bits of each table, each bit in one table only. Taken one by one, the least correlated with those that the table has,
// the most balanced of equals: by descriptors of this ORB from rendered rooms. PlaceIndex tests
// say what they are worth.
constexpr std::array<std::array<std::uint8_t, PlaceIndex::kBits>, PlaceIndex::kTables> kChosen = {{
    {41, 112, 105, 4, 97, 70, 26, 45, 214, 195, 108, 231, 154, 215, 115, 207},
    {79, 34, 30, 187, 47, 172, 218, 236, 35, 40, 99, 241, 91, 177, 147, 48},
    {46, 63, 65, 116, 213, 163, 165, 145, 141, 164, 130, 3, 56, 101, 38, 201},
    {87, 24, 169, 137, 150, 136, 173, 81, 36, 86, 123, 155, 176, 221, 93, 16},
    {78, 49, 11, 89, 249, 151, 118, 156, 243, 139, 106, 149, 55, 77, 129, 135},
    {8, 43, 29, 74, 69, 158, 245, 206, 220, 157, 88, 227, 230, 84, 121, 20},
}};

constexpr std::size_t kLeastCommon = 50;  // keyframes: a word in fewer is never too common
constexpr std::size_t kMostShare = 5;     // a word in more than one of so many keyframes says nothing
constexpr std::size_t kLeastDead = 64;    // slots, before the lists are made anew

}  // namespace

PlaceIndex::PlaceIndex() : lists_(static_cast<std::size_t>(kTables) << kBits) {}

std::uint16_t PlaceIndex::Word(int table, const Descriptor& descriptor) {
  unsigned word = 0;
  for (const std::uint8_t bit : kChosen[static_cast<std::size_t>(table)]) {
    word = (word << 1U) | static_cast<unsigned>((descriptor[bit >> 6U] >> (bit & 63U)) & 1U);
  }
  return static_cast<std::uint16_t>(word);
}

// Each once.
std::vector<std::uint16_t> PlaceIndex::Words(int table, std::span<const Descriptor> descriptors) {
  std::vector<std::uint16_t> words;
  words.reserve(descriptors.size());
  for (const Descriptor& descriptor : descriptors) {
    words.push_back(Word(table, descriptor));
  }
  std::ranges::sort(words);
  const auto rest = std::ranges::unique(words);
  words.erase(rest.begin(), rest.end());
  return words;
}

void PlaceIndex::Add(KeyframeId keyframe, std::span<const Descriptor> descriptors) {
  Remove(keyframe);
  const auto slot = static_cast<Slot>(keyframe_of_.size());
  keyframe_of_.push_back(keyframe);
  slot_of_[keyframe] = slot;
  for (int table = 0; table < kTables; ++table) {
    for (const std::uint16_t word : Words(table, descriptors)) {
      List(table, word).push_back(slot);
    }
  }
}

void PlaceIndex::Remove(KeyframeId keyframe) {
  if (const auto found = slot_of_.find(keyframe); found != slot_of_.end()) {
    keyframe_of_[found->second] = KeyframeId{};
    slot_of_.erase(found);
    if (const std::size_t dead = keyframe_of_.size() - slot_of_.size();
        dead >= kLeastDead && 4 * dead >= keyframe_of_.size()) {
      Compact();
    }
  }
}

void PlaceIndex::Compact() {
  constexpr Slot kDead = ~Slot{0};
  std::vector<Slot> renumbered(keyframe_of_.size(), kDead);
  std::vector<KeyframeId> living;
  for (std::size_t slot = 0; slot < keyframe_of_.size(); ++slot) {
    if (keyframe_of_[slot].valid()) {
      renumbered[slot] = static_cast<Slot>(living.size());
      slot_of_[keyframe_of_[slot]] = renumbered[slot];
      living.push_back(keyframe_of_[slot]);
    }
  }
  for (std::vector<Slot>& list : lists_) {
    std::vector<Slot> kept;
    for (const Slot slot : list) {
      if (renumbered[slot] != kDead) {
        kept.push_back(renumbered[slot]);
      }
    }
    list.swap(kept);  // with its memory
  }
  keyframe_of_ = std::move(living);
}

std::vector<PlaceScore> PlaceIndex::Query(std::span<const Descriptor> descriptors) const {
  const std::size_t most = std::max(kLeastCommon, slot_of_.size() / kMostShare);
  const double documents = static_cast<double>(slot_of_.size()) + 1;
  std::vector<float> scores(keyframe_of_.size(), 0.0F);
  for (int table = 0; table < kTables; ++table) {
    for (const std::uint16_t word : Words(table, descriptors)) {
      const std::vector<Slot>& list = List(table, word);
      if (!list.empty() && list.size() <= most) {
        const auto weight = static_cast<float>(std::log(documents / static_cast<double>(list.size())));
        for (const Slot slot : list) {
          scores[slot] += weight;
        }
      }
    }
  }
  std::vector<PlaceScore> found;
  for (std::size_t slot = 0; slot < scores.size(); ++slot) {
    if (scores[slot] > 0 && keyframe_of_[slot].valid()) {
      found.push_back({keyframe_of_[slot], scores[slot]});
    }
  }
  std::ranges::sort(found, {}, &PlaceScore::keyframe);
  return found;
}

std::vector<KeyframeId> PlaceIndex::Keyframes() const {
  std::vector<KeyframeId> keyframes;
  for (const auto& [keyframe, slot] : slot_of_) {
    keyframes.push_back(keyframe);
  }
  std::ranges::sort(keyframes);
  return keyframes;
}

std::size_t PlaceIndex::Memory() const {
  std::size_t bytes = keyframe_of_.capacity() * sizeof(KeyframeId);
  for (const std::vector<Slot>& list : lists_) {
    bytes += list.capacity() * sizeof(Slot);
  }
  return bytes;
}

}  // namespace rds
