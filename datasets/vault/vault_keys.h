// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "datasets/vault/sealed_file.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/memory/segment_types.h"

namespace engram::datasets::vault {

/// A day of UTC, counted from 1970-01-01; negative before.
using Day = int32_t;

[[nodiscard]] Day day_of(Time time);
/// The first and the last moment of a day.
[[nodiscard]] Time day_begin(Day day);
[[nodiscard]] Time day_end(Day day);
/// "2022-02-18".
[[nodiscard]] std::string day_text(Day day);
/// "2022-02-18 Vision/RGB/head/cam", as a person may read it on a terminal.
[[nodiscard]] std::string printable_day(const ltm::MemoryId& entity, Day day);
/// Errors: kInvalidArgument.
Result<Day> parse_day(std::string_view text);

/// What is kept of one entity and day.
struct VaultDay {
  RandomId file{};
  SecretKey key;
  uint64_t snapshots = 0;
  uint64_t instances = 0;
  Time first{};
  Time last{};
  uint64_t raw_bytes = 0;   ///< Plain size of the values.
  uint64_t file_bytes = 0;  ///< Size of the encrypted file.
  /// Snapshots whose recorded form was gone: their values were decoded from latents.
  uint64_t reconstructed = 0;
  uint64_t source = 0;  ///< Where the store had it; the same as long as nothing there changed.
  uint64_t times = 0;   ///< Made of the times of the snapshots, and of redactions of the day.
  uint64_t digest = 0;  ///< Made of the records of the file: the same for the same content.
};

/// A day whose key was destroyed.
struct DestroyedDay {
  RandomId file{};  ///< To be removed where the vault is within reach.
  Time when{};
};

/// The content of a key file: all keys of a vault, and what is in which of its files.
///
/// Threading: one thread.
/// Source: docs/vault.md, section "The key file".
struct VaultKeys {
  RandomId vault{};
  std::string store_id;  ///< The store that it is a copy of; empty before the first export.
  ltm::SegmentTypes types;
  std::map<ltm::MemoryId, std::map<Day, VaultDay>> days;
  std::map<ltm::MemoryId, std::map<Day, DestroyedDay>> destroyed;
  /// Files of days that were exported anew, to be removed. Their keys are gone.
  std::set<RandomId> obsolete;

  /// Null if there is none.
  [[nodiscard]] const VaultDay* find(const ltm::MemoryId& entity, Day day) const;
  [[nodiscard]] bool is_destroyed(const ltm::MemoryId& entity, Day day) const;
  [[nodiscard]] uint64_t day_count() const;
  [[nodiscard]] uint64_t destroyed_count() const;
};

/// Writes keys as the bytes of a key file. Errors: kInvalidArgument if a type nests too deep.
Result<SecretBytes> encode_keys(const VaultKeys& keys);

/// Reads what encode_keys wrote; safe on hostile bytes.
/// Errors: kDataLoss; kFailedPrecondition if it has a newer version.
Result<VaultKeys> decode_keys(std::span<const std::byte> bytes);

}  // namespace engram::datasets::vault
