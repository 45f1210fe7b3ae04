// SPDX-License-Identifier: Apache-2.0
// Strong ids: a keyframe's id cannot be passed where a point's is wanted.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace rds {

// An id of kind `Tag`; value 2^32 - 1 means "none". Ids are given in order of creation and never used twice.
template <typename Tag>
struct Id {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = kNone;

  [[nodiscard]] constexpr bool valid() const { return value != kNone; }
  [[nodiscard]] constexpr std::size_t index() const { return value; }
  constexpr auto operator<=>(const Id&) const = default;
};

using FrameId = Id<struct FrameTag>;        // position of a frame in the sequence, from 0
using KeyframeId = Id<struct KeyframeTag>;  // dense, from 0
using PointId = Id<struct PointTag>;        // dense, from 0
using WorldId = Id<struct WorldTag>;        // dense, from 0

}  // namespace rds

template <typename Tag>
struct std::hash<rds::Id<Tag>> {
  std::size_t operator()(const rds::Id<Tag>& id) const noexcept { return id.value; }
};
