// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace rds {

// RFC 4648, with padding, in one line.
[[nodiscard]] std::string Base64(std::string_view bytes);

}  // namespace rds
