// SPDX-License-Identifier: Apache-2.0
// Which column of a trajectory file holds what.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "io/text_table.h"

namespace rds {

// Columns of timestamp tx ty tz qx qy qz qw, from 0.
using PoseColumns = std::array<std::size_t, 8>;

// By the heading where it names all eight (EuRoC's, csv files of others), else the TUM benchmark's for eight columns,
// or for nine of which the first counts the rows. Nothing where that is not certain.
[[nodiscard]] std::optional<PoseColumns> FindPoseColumns(const TextTable& table);

}  // namespace rds
