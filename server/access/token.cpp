// SPDX-License-Identifier: Apache-2.0
#include "server/access/token.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <sys/random.h>

#include <algorithm>
#include <cerrno>
#include <span>
#include <system_error>

#include "ltm/idf/base64.h"

namespace engram::server {

namespace {

constexpr size_t kTokenBytes = 32;

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

Status fill_randomly(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::getrandom(bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return unavailable("token: the system gives no random bytes: {}",
                         std::generic_category().message(errno));
    bytes = bytes.subspan(static_cast<size_t>(count));
  }
  return {};
}

}  // namespace

Result<std::string> make_token() {
  std::array<std::byte, kTokenBytes> bytes{};
  ENGRAM_RETURN_IF_ERROR(fill_randomly(bytes));
  std::string token = idf::to_base64(bytes);
  OPENSSL_cleanse(bytes.data(), bytes.size());
  std::ranges::replace(token, '+', '-');
  std::ranges::replace(token, '/', '_');
  std::erase(token, '=');
  return token;
}

TokenHash hash_token(std::string_view token) {
  TokenHash hash{};
  const int is_done =
      EVP_Digest(token.data(), token.size(), reinterpret_cast<unsigned char*>(hash.data()), nullptr,
                 EVP_sha256(), nullptr);
  ENGRAM_CHECK(is_done == 1, "SHA-256 of {} bytes", token.size());
  return hash;
}

std::string to_hex(const TokenHash& hash) {
  std::string hex;
  for (const std::byte byte : hash) hex += fmt::format("{:02x}", std::to_integer<unsigned>(byte));
  return hex;
}

std::optional<TokenHash> token_hash_from_hex(std::string_view hex) {
  TokenHash hash{};
  if (hex.size() != 2 * hash.size()) return std::nullopt;
  for (size_t i = 0; i < hash.size(); ++i) {
    const auto high = hex_digit(hex[2 * i]);
    const auto low = hex_digit(hex[2 * i + 1]);
    if (!high || !low) return std::nullopt;
    hash[i] = static_cast<std::byte>(*high << 4 | *low);
  }
  return hash;
}

bool equal_in_constant_time(const TokenHash& a, const TokenHash& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace engram::server
