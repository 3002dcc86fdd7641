// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace engram::idf {

/// RFC 4648 base64 with padding.
[[nodiscard]] std::string to_base64(std::span<const std::byte> bytes);

/// Nothing where `text` is not canonical padded base64.
[[nodiscard]] std::optional<std::vector<std::byte>> from_base64(std::string_view text);

}  // namespace engram::idf
