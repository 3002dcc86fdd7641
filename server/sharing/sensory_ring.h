// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "ltm/core/status.h"

namespace engram::server {

/// The min size of a ring's memory. Unit: bytes.
inline constexpr size_t kMinSensoryRing = size_t{64} << 10;

/// The max number of entities of one ring: each has a bit.
inline constexpr size_t kMaxRingEntities = 64;

/// The max size of what an entry says besides its data: the server reads no more. Unit: bytes.
inline constexpr size_t kMaxHeadBytes = size_t{1} << 20;

/// What the server tells the provider that writes a ring: shared memory that the server writes.
///
/// The order of changes matters, see docs/sensory.md, "How opening is exact".
struct SensoryControl {
  std::atomic<uint64_t> attended{0};   ///< A bit for each entity to which somebody attends.
  std::atomic<uint64_t> taken{0};      ///< Entries before it may be overwritten whoever attends.
  std::atomic<uint64_t> is_closed{0};  ///< Not zero: nobody reads this ring any more.
  /// Of each entity the first entry that did not pass. It tells the provider what it loses.
  std::array<std::atomic<uint64_t>, kMaxRingEntities> passed_until{};
};
static_assert(std::atomic<uint64_t>::is_always_lock_free &&
              sizeof(SensoryControl) == (3 + kMaxRingEntities) * sizeof(uint64_t));

/// What a ring says of one entry. Its data come first, at a whole cache line, then its head.
struct SensoryEntry {
  uint64_t sequence = 0;  ///< Counts the entries of the ring from zero.
  uint64_t entities = 0;  ///< A bit for each entity that it has a snapshot of.
  int64_t came_ns = 0;    ///< When it was written, by the host's clock that is never set.
  uint64_t offset = 0;    ///< In the ring's memory. Unit: bytes.
  uint64_t head_bytes = 0;
  uint64_t data_bytes = 0;
  int64_t first_time_ns = 0;  ///< The earliest time of its snapshots.
};

/// How a ring's memory is divided: counts, then a slot for each entry, then the entries' bytes. It
/// follows from the memory's size alone, so that none of it has to be believed.
///
/// Threading: immutable.
class SensoryLayout {
 public:
  /// The counts at the beginning, which the provider alone writes.
  struct Counts {
    uint64_t valid_from;   ///< The first entry that is not overwritten.
    uint64_t written;      ///< The number of entries so far: those below it can be read.
    uint64_t snapshots;    ///< In all entries so far.
    uint64_t crowded_out;  ///< Snapshots that were lost before their time, and did not pass.
  };
  static constexpr size_t kSlotWords = 8;
  static constexpr size_t kSlotBytes = kSlotWords * sizeof(uint64_t);

  /// Needs at least kMinSensoryRing bytes (checked).
  explicit SensoryLayout(size_t bytes);

  [[nodiscard]] uint64_t slots() const { return slots_; }
  [[nodiscard]] size_t slot_of(uint64_t sequence) const {
    return kSlotBytes * (1 + sequence % slots_);
  }
  [[nodiscard]] size_t data_begin() const { return kSlotBytes * (1 + slots_); }
  [[nodiscard]] size_t data_end() const { return bytes_; }
  [[nodiscard]] size_t data_bytes() const { return bytes_ - data_begin(); }

 private:
  size_t bytes_;
  uint64_t slots_;
};

/// The server's end of a ring: reads what another process writes, at any time and whatever it
/// writes. Nothing of it is believed, and no byte outside the memory is read.
///
/// Threading: const-parallel.
/// Source: docs/sensory.md.
class SensoryRingReader {
 public:
  /// The memory must outlive it. Needs at least kMinSensoryRing bytes that begin at a multiple of 8
  /// (checked).
  explicit SensoryRingReader(std::span<const std::byte> memory);

  /// The entries that can be read now: from `first` on, below `end`.
  struct Range {
    uint64_t first = 0;
    uint64_t end = 0;
  };
  [[nodiscard]] Range entries() const;

  /// What a ring says of an entry; nothing if it is overwritten, or says what cannot be.
  [[nodiscard]] std::optional<SensoryEntry> find(uint64_t sequence) const;

  /// Copies a part of an entry's bytes. Returns false if it does not lie within them, or if they
  /// were overwritten until the end of the call: what was copied is of no use then.
  [[nodiscard]] bool copy(const SensoryEntry& entry, uint64_t offset,
                          std::span<std::byte> to) const;

  [[nodiscard]] uint64_t snapshots() const;
  [[nodiscard]] uint64_t crowded_out() const;

 private:
  [[nodiscard]] uint64_t word(size_t offset) const;

  std::span<const std::byte> memory_;
  SensoryLayout layout_;
};

}  // namespace engram::server
