// SPDX-License-Identifier: Apache-2.0
#include "base/sha256.h"

#include <gtest/gtest.h>

#include <fstream>
#include <tuple>

#include "base/error.h"
#include "testing/temporary_folder.h"

namespace rds {
namespace {

// The examples of FIPS 180-2.
TEST(Sha256, IsThatOfTheStandard) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "abc") << "abc";
  EXPECT_EQ(Sha256(folder.path() / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  std::ofstream(folder.path() / "many") << std::string(1'000'000, 'a');
  EXPECT_EQ(Sha256(folder.path() / "many"), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_THROW(std::ignore = Sha256(folder.path() / "none"), InputError);
}

}  // namespace
}  // namespace rds
