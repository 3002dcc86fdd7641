// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::server {

/// The SHA-256 of a token, which is all that servers keep of it.
using TokenHash = std::array<std::byte, 32>;

/// Makes a new token: 32 random bytes of the system as URL-safe base64 without padding, 43
/// characters.
/// Errors: kUnavailable if the system has no random bytes.
Result<std::string> make_token();

[[nodiscard]] TokenHash hash_token(std::string_view token);

/// Returns 64 hexadecimal digits, as `sha256sum` prints them.
[[nodiscard]] std::string to_hex(const TokenHash& hash);
[[nodiscard]] std::optional<TokenHash> token_hash_from_hex(std::string_view hex);

/// Compares two hashes in a time that does not depend on their values.
[[nodiscard]] bool equal_in_constant_time(const TokenHash& a, const TokenHash& b);

}  // namespace engram::server
