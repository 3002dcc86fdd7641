// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace engram::idf {

/// Encodes bytes as base64 with padding. Source: RFC 4648.
[[nodiscard]] std::string to_base64(std::span<const std::byte> bytes);

/// Decodes base64; nothing where `text` is not canonical padded base64.
[[nodiscard]] std::optional<std::vector<std::byte>> from_base64(std::string_view text);

}  // namespace engram::idf
