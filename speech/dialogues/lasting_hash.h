// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what is held out is chosen by a hash of its name.

#include <cstdint>
#include <string_view>

namespace engram::speech::dialogues {

/// FNV-1a, mixed once more so that short names that differ in one letter are spread. The same
/// always, on every machine.
[[nodiscard]] constexpr uint64_t lasting_hash(std::string_view text) {
  uint64_t hash = 14695981039346656037ULL;
  for (const char letter : text) {
    hash ^= static_cast<unsigned char>(letter);
    hash *= 1099511628211ULL;
  }
  hash ^= hash >> 29;
  hash *= 0xBF58476D1CE4E5B9ULL;
  return hash ^ (hash >> 32);
}

}  // namespace engram::speech::dialogues
