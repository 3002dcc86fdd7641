// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace engram::server {

/// What the holder of a token may do.
enum class Right : uint8_t {
  kRead,    ///< Query the past, and subscribe.
  kModels,  ///< Ask what models and engines predict; they learned from all times.
  kWrite,   ///< Commit and declare types.
  kErase,   ///< Forget for good, and be told how much that is.
};

/// "read", "models", "write", "erase".
[[nodiscard]] std::string_view to_string(Right right);

}  // namespace engram::server
