// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace rds {
namespace {

static_assert(!std::is_base_of_v<InputError, InvariantError> && !std::is_base_of_v<InvariantError, InputError>);

TEST(Check, PassesIfTrue) { EXPECT_NO_THROW(Check(true, "fine")); }

TEST(Check, NamesThePlaceAndTheReason) {
  const int line = __LINE__ + 2;
  try {
    Check(1 > 2, "one is not above two");
    FAIL() << "no exception";
  } catch (const InvariantError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("error_test.cc:" + std::to_string(line)), std::string::npos) << what;
    EXPECT_NE(what.find("one is not above two"), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace rds
