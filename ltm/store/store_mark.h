// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace engram::ltm {

/// How a store looks from outside. Where it looks the same as before, nothing was published and
/// nothing was written to a journal meanwhile; to find that out takes microseconds, to open a store
/// milliseconds.
struct StoreMark {
  /// Inode, time of the last change in nanoseconds, and size: a manifest is replaced, never
  /// changed.
  std::array<int64_t, 3> manifest{};
  std::map<std::string, uint64_t> journals;  ///< Bytes of each file; they only grow.

  friend bool operator==(const StoreMark&, const StoreMark&) = default;
};

/// Nothing fails: what cannot be looked at is as if it were not there.
[[nodiscard]] StoreMark look_at_store(const std::filesystem::path& store);

}  // namespace engram::ltm
