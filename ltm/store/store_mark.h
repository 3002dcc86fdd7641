// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace engram::ltm {

/// The outside state of a store. If two marks are equal, nothing was published and no journal was
/// written between them. Taking a mark costs microseconds; opening a store costs milliseconds.
struct StoreMark {
  /// Inode, time of the last change in nanoseconds, and size. These suffice because a manifest is
  /// replaced, never changed in place.
  std::array<int64_t, 3> manifest{};
  std::map<std::string, uint64_t> journals;  ///< Bytes of each file; they only grow.

  friend bool operator==(const StoreMark&, const StoreMark&) = default;
};

/// Takes the mark of a store. It never fails: a file that cannot be inspected counts as missing.
[[nodiscard]] StoreMark look_at_store(const std::filesystem::path& store);

}  // namespace engram::ltm
