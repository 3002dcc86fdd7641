// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/ascii.h"

#include <gtest/gtest.h>

namespace engram {
namespace {

TEST(LowerAscii, ChangesNothingButTheLettersAToZ) {
  EXPECT_EQ(lower_ascii("AZaz@[`{09 \xC3\x84"), "azaz@[`{09 \xC3\x84");
  EXPECT_EQ(lower_ascii(""), "");
}

}  // namespace
}  // namespace engram
