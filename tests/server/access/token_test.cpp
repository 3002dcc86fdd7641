// SPDX-License-Identifier: Apache-2.0
#include "server/access/token.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

TEST(Token, IsNewEachTimeAndFitsIntoAUrl) {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) {
    const auto token = make_token();
    ASSERT_OK(token);
    EXPECT_EQ(token->size(), 43u);
    EXPECT_TRUE(std::ranges::all_of(*token, [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
             c == '-' || c == '_';
    })) << *token;
    EXPECT_TRUE(seen.insert(*token).second);
  }
}

TEST(Token, HashesAsSha256sumDoes) {
  // The examples of FIPS 180-2.
  EXPECT_EQ(to_hex(hash_token("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(to_hex(hash_token("")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Token, ReadsBackTheHexadecimalForm) {
  const TokenHash hash = hash_token("abc");
  EXPECT_EQ(token_hash_from_hex(to_hex(hash)), hash);
  std::string upper = to_hex(hash);
  std::ranges::transform(upper, upper.begin(), [](char c) { return std::toupper(c); });
  EXPECT_EQ(token_hash_from_hex(upper), hash);
}

TEST(Token, RefusesWhatIsNoHash) {
  const std::string hex = to_hex(hash_token("abc"));
  EXPECT_EQ(token_hash_from_hex(""), std::nullopt);
  EXPECT_EQ(token_hash_from_hex(hex.substr(1)), std::nullopt);
  EXPECT_EQ(token_hash_from_hex(hex + "0"), std::nullopt);
  EXPECT_EQ(token_hash_from_hex("g" + hex.substr(1)), std::nullopt);
  EXPECT_EQ(token_hash_from_hex("+" + hex.substr(1)), std::nullopt);
}

TEST(Token, ComparesAllBytes) {
  const TokenHash hash = hash_token("abc");
  EXPECT_TRUE(equal_in_constant_time(hash, hash));
  for (size_t i = 0; i < hash.size(); ++i) {
    TokenHash other = hash;
    other[i] ^= std::byte{1};
    EXPECT_FALSE(equal_in_constant_time(hash, other));
  }
}

}  // namespace
}  // namespace engram::server
