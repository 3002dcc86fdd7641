// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "ltm/core/time.h"
#include "server/sharing/sensory_ring.h"

namespace engram::server {

/// The provider's end of a ring, which it alone writes.
///
/// An entry stays for the time to hold and, beyond that, until its room is needed. Room is taken
/// where it is free lowest in memory, so that a ring costs RAM for what it holds and not for its
/// size.
/// Threading: one thread.
/// Source: docs/sensory.md.
class SensoryRingWriter {
 public:
  /// Both memories must outlive it; `control` is written by the server. Needs as much as
  /// SensoryRingReader does (checked).
  SensoryRingWriter(std::span<std::byte> memory, const SensoryControl& control, Duration hold);

  /// Room for one entry: for its data, and behind them for its head.
  struct Room {
    std::span<std::byte> data;
    std::span<std::byte> head;
    size_t offset = 0;  ///< In the ring's memory.
  };

  /// Asks the server to take what it still needs, and waits until it did. Nothing can be done where
  /// it does not answer.
  using Sync = std::function<void()>;

  /// Makes room for an entry. Entries whose time is over make room, then the oldest ones. The
  /// server is asked while it can still read them; what it did not take is counted. The room is
  /// there until the next call.
  /// Errors: kResourceExhausted if the ring is smaller, or what is lent leaves no room.
  Result<Room> reserve(size_t head_bytes, size_t data_bytes, SteadyTime now, const Sync& sync);

  /// The same, but the room stays until take_back() or give_back(). No more than half of the ring
  /// is lent.
  Result<Room> lend(size_t head_bytes, size_t data_bytes, SteadyTime now, const Sync& sync);
  /// Has publish() show an entry in a room that was lent, with so much of its head.
  void take_back(const Room& lent, size_t head_bytes, SteadyTime now, const Sync& sync);
  /// Frees a room that was lent.
  void give_back(const Room& lent);

  /// Shows the entry that there is room for, with a snapshot of each of `entities`, of
  /// which the earliest is of the time `first`. Returns its number.
  uint64_t publish(uint64_t entities, Time first, SteadyTime now);

  /// Whether anybody attends to one of these entities. After publish(), an entry passes for sure:
  /// either this says so and the server is to be told, or the server sees it by itself.
  [[nodiscard]] bool is_attended(uint64_t entities) const;
  [[nodiscard]] bool is_closed() const;

  /// The number of entries so far.
  [[nodiscard]] uint64_t written() const { return written_; }

 private:
  struct Live {
    uint64_t sequence = 0;
    uint64_t entities = 0;  ///< It has a snapshot of each.
    size_t offset = 0;
    size_t bytes = 0;
    SteadyTime came;
  };

  void set(size_t offset, uint64_t value, int order);
  [[nodiscard]] std::optional<size_t> find_room(size_t bytes);
  /// Forgets the oldest entry; its bytes are free.
  void free_oldest();
  void announce(const Sync& sync);
  /// Forgets entries until `has_room` says so. Returns what it said last.
  template <typename HasRoom>
  bool free_until(const HasRoom& has_room, SteadyTime now, const Sync& sync);
  void occupy(size_t offset, size_t end);
  /// Whether there would be room if nothing were there but what is lent.
  [[nodiscard]] bool fits_beside_lent(size_t bytes) const;
  /// The snapshots of an entry that did not pass. Its entities passed up to some entry each.
  [[nodiscard]] uint64_t lost_of(const Live& entry) const;

  std::span<std::byte> memory_;
  const SensoryControl& control_;
  const Duration hold_;
  const SensoryLayout layout_;
  std::deque<Live> live_;            ///< The oldest first.
  std::map<size_t, size_t> places_;  ///< Of those and of what is lent: the end by the offset.
  std::map<size_t, size_t> lent_places_;
  uint64_t written_ = 0;
  uint64_t announced_ = 0;  ///< The first entry that is not overwritten, as others know it.
  uint64_t snapshots_ = 0;
  uint64_t crowded_out_ = 0;
  size_t next_ = 0;        ///< Where the last entry ended.
  size_t high_water_ = 0;  ///< No entry has gone beyond it.
  size_t used_ = 0;        ///< Bytes of those that are there, and of what is lent.
  size_t lent_ = 0;        ///< Of these what is lent.
  SensoryEntry reserved_;
};

}  // namespace engram::server
