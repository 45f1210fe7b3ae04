// SPDX-License-Identifier: Apache-2.0
// The table that names, bounds and explains all options.
#pragma once

#include "system/option_table.h"
#include "system/options.h"

namespace rds {

// The table of all options, bound to `options`, which must outlive it. The order is the order of printing; keys with
// the same first part stand together.
[[nodiscard]] OptionTable BindOptions(Options& options);

}  // namespace rds
