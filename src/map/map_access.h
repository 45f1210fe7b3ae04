// SPDX-License-Identifier: Apache-2.0
// How algorithms reach the map: they plan on it, solve without it, and commit what they found.
#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

#include "map/map.h"

namespace rds {

// The map behind whatever guards it. Read and Write run a function on it while nobody else changes it: nothing slow
// inside, and never one within the other.
class MapAccess {
 public:
  MapAccess() = default;
  virtual ~MapAccess() = default;
  MapAccess(const MapAccess&) = delete;
  MapAccess& operator=(const MapAccess&) = delete;

  template <typename Function>
  auto Read(Function&& function) const {
    return Within<const Map>(function, [this](const auto& run) { DoRead(run); });
  }
  template <typename Function>
  auto Write(Function&& function) {
    return Within<Map>(function, [this](const auto& run) { DoWrite(run); });
  }

  // One job: `plan(const Map&)` copies out a problem (optional: none = nothing to do), `solve(problem)` works on it
  // while others may change the map, and its Correction (optional: none = nothing found) is applied.
  template <typename Plan, typename Solve>
  Applied Commit(Plan&& plan, Solve&& solve) {
    const auto problem = Read(std::forward<Plan>(plan));
    if (!problem) {
      return {};
    }
    const std::optional<Correction> correction = solve(*problem);
    return correction ? Write([&](Map& map) { return map.Apply(*correction); }) : Applied{};
  }

 protected:
  virtual void DoRead(const std::function<void(const Map&)>& function) const = 0;
  virtual void DoWrite(const std::function<void(Map&)>& function) = 0;

 private:
  // Runs a function within a guard and brings its value out.
  template <typename MapType, typename Function, typename Guard>
  static auto Within(Function& function, Guard&& guard) {
    using Result = std::invoke_result_t<Function&, MapType&>;
    if constexpr (std::is_void_v<Result>) {
      guard([&](MapType& map) { function(map); });
    } else {
      std::optional<Result> result;
      guard([&](MapType& map) { result.emplace(function(map)); });
      return *std::move(result);
    }
  }
};

}  // namespace rds
