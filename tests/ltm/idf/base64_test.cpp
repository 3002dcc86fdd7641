// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/base64.h"

#include <gtest/gtest.h>

#include "ltm/core/buffer.h"
#include "tests/ltm/random_values.h"

namespace engram::idf {
namespace {

TEST(Base64, WritesTheExamplesOfRfc4648) {
  const std::pair<const char*, const char*> cases[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : cases) EXPECT_EQ(to_base64(as_bytes(plain)), coded);
}

TEST(Base64, ReadsBackRandomBytes) {
  RandomValues random(1);
  for (size_t size = 0; size < 200; ++size) {
    std::vector<std::byte> bytes(size);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.bits());
    EXPECT_EQ(from_base64(to_base64(bytes)), bytes);
  }
}

TEST(Base64, RefusesWhatIsBroken) {
  for (const char* text : {"Z", "Zg", "Zg=", "Z===", "====", "Zm9v!mFy",
                           "Zg==Zg==", "Zh==", "Zm9=", "Zm 9", "=m9v", "Zm=v"})
    EXPECT_EQ(from_base64(text), std::nullopt) << text;
}

}  // namespace
}  // namespace engram::idf
