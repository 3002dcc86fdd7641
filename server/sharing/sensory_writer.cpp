// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sensory_writer.h"

#include <algorithm>
#include <bit>

#include "ltm/core/check.h"
#include "server/sharing/ring_places.h"

namespace engram::server {

namespace {

/// Entries begin at whole cache lines, and none is empty.
constexpr size_t to_whole_lines(size_t bytes) {
  return (std::max<size_t>(bytes, 1) + 63) / 64 * 64;
}

}  // namespace

SensoryRingWriter::SensoryRingWriter(std::span<std::byte> memory, const SensoryControl& control,
                                     Duration hold)
    : memory_(memory), control_(control), hold_(hold), layout_(memory.size()) {
  ENGRAM_CHECK(reinterpret_cast<uintptr_t>(memory.data()) % alignof(uint64_t) == 0,
               "a ring begins at {}", static_cast<const void*>(memory.data()));
  next_ = layout_.data_begin();
  high_water_ = next_;
}

void SensoryRingWriter::set(size_t offset, uint64_t value, int order) {
  auto* at = reinterpret_cast<uint64_t*>(memory_.data() + offset);
  if (order == __ATOMIC_RELEASE)
    __atomic_store_n(at, value, __ATOMIC_RELEASE);
  else
    __atomic_store_n(at, value, __ATOMIC_RELAXED);
}

std::optional<size_t> SensoryRingWriter::find_room(size_t bytes) {
  // Behind the last entry, as long as that does not take pages that were never used.
  if (next_ + bytes <= high_water_) {
    const auto after = places_.lower_bound(next_);
    const bool is_free = after == places_.begin() || std::prev(after)->second <= next_;
    if (is_free && (after == places_.end() || after->first >= next_ + bytes)) return next_;
  }
  // Nothing is looked for between entries that leave no room: a thousand small ones a second would
  // each be compared with all that are held.
  const size_t free_between = high_water_ - layout_.data_begin() - used_;
  if (free_between < bytes && high_water_ + bytes <= layout_.data_end()) return high_water_;
  size_t begin = layout_.data_begin();
  for (const auto& [offset, end] : places_) {
    if (offset - begin >= bytes) return begin;
    begin = end;
  }
  if (layout_.data_end() - begin < bytes) return std::nullopt;
  return begin;
}

void SensoryRingWriter::free_oldest() {
  used_ -= live_.front().bytes;
  places_.erase(live_.front().offset);
  live_.pop_front();
}

/// Says which entries are overwritten from now on, before the first byte is. The server reads
/// nothing that was said to be overwritten, so it is asked first. Whoever opens attention after the
/// look at `attended` comes too late for these entries.
void SensoryRingWriter::announce(const Sync& sync) {
  const uint64_t valid_from = written_ - live_.size();
  if (valid_from == announced_) return;
  if (control_.attended.load(std::memory_order_seq_cst) != 0 &&
      control_.taken.load(std::memory_order_seq_cst) < valid_from)
    sync();
  announced_ = valid_from;
  set(offsetof(SensoryLayout::Counts, valid_from), valid_from, __ATOMIC_RELEASE);
  // Ahead of the bytes, which may be written past the processor's caches.
  std::atomic_thread_fence(std::memory_order_seq_cst);
}

uint64_t SensoryRingWriter::lost_of(const Live& entry) const {
  uint64_t lost = 0;
  for (const size_t place : RingPlaces(entry.entities)) {
    if (control_.passed_until[place].load(std::memory_order_acquire) <= entry.sequence) ++lost;
  }
  return lost;
}

template <typename HasRoom>
bool SensoryRingWriter::free_until(const HasRoom& has_room, SteadyTime now, const Sync& sync) {
  while (!live_.empty() && now - live_.front().came > hold_) free_oldest();
  std::vector<Live> crowded;
  bool is_free = has_room();
  while (!is_free && !live_.empty()) {
    crowded.push_back(live_.front());
    free_oldest();
    is_free = has_room();
  }
  announce(sync);
  for (const Live& entry : crowded) crowded_out_ += lost_of(entry);
  set(offsetof(SensoryLayout::Counts, crowded_out), crowded_out_, __ATOMIC_RELAXED);
  return is_free;
}

Result<SensoryRingWriter::Room> SensoryRingWriter::reserve(size_t head_bytes, size_t data_bytes,
                                                           SteadyTime now, const Sync& sync) {
  const size_t max = layout_.data_bytes() - lent_;
  if (head_bytes > max || data_bytes > max - head_bytes ||
      to_whole_lines(head_bytes + data_bytes) > max)
    return resource_exhausted("sensory ring: an entry has {} bytes, needs at most {}",
                              head_bytes + data_bytes, max);
  const size_t bytes = to_whole_lines(head_bytes + data_bytes);
  // Before anything makes way for it in vain.
  if (!fits_beside_lent(bytes))
    return resource_exhausted("sensory ring: what is lent leaves no {} bytes beside each other",
                              bytes);
  std::optional<size_t> offset;
  const bool is_free = free_until(
      [&] { return live_.size() < layout_.slots() && (offset = find_room(bytes)).has_value(); },
      now, sync);
  ENGRAM_CHECK(is_free, "no room for {} bytes, though {} are lent", bytes, lent_);
  reserved_ = {written_, 0, 0, *offset, head_bytes, data_bytes, 0};
  const std::span<std::byte> room = memory_.subspan(*offset, head_bytes + data_bytes);
  return Room{room.first(data_bytes), room.subspan(data_bytes), *offset};
}

bool SensoryRingWriter::fits_beside_lent(size_t bytes) const {
  size_t begin = layout_.data_begin();
  for (const auto& [offset, end] : lent_places_) {
    if (offset - begin >= bytes) return true;
    begin = end;
  }
  return layout_.data_end() - begin >= bytes;
}

void SensoryRingWriter::occupy(size_t offset, size_t end) {
  places_.emplace(offset, end);
  used_ += end - offset;
  next_ = end;
  high_water_ = std::max(high_water_, end);
}

Result<SensoryRingWriter::Room> SensoryRingWriter::lend(size_t head_bytes, size_t data_bytes,
                                                        SteadyTime now, const Sync& sync) {
  const size_t max = layout_.data_bytes() / 2 - std::min(lent_, layout_.data_bytes() / 2);
  if (head_bytes > max || data_bytes > max - head_bytes)
    return resource_exhausted("sensory ring: {} bytes are lent, needs at most half of {}", lent_,
                              layout_.data_bytes());
  ENGRAM_ASSIGN_OR_RETURN(const Room room, reserve(head_bytes, data_bytes, now, sync));
  const size_t bytes = to_whole_lines(head_bytes + data_bytes);
  occupy(room.offset, room.offset + bytes);
  lent_places_.emplace(room.offset, room.offset + bytes);
  lent_ += bytes;
  return room;
}

void SensoryRingWriter::give_back(const Room& lent) {
  const auto place = lent_places_.find(lent.offset);
  ENGRAM_CHECK(place != lent_places_.end(), "nothing is lent at {}", lent.offset);
  used_ -= place->second - lent.offset;
  lent_ -= place->second - lent.offset;
  places_.erase(lent.offset);
  lent_places_.erase(place);
}

void SensoryRingWriter::take_back(const Room& lent, size_t head_bytes, SteadyTime now,
                                  const Sync& sync) {
  ENGRAM_CHECK(head_bytes <= lent.head.size(), "a head of {} of {} bytes", head_bytes,
               lent.head.size());
  free_until([this] { return live_.size() < layout_.slots(); }, now, sync);
  give_back(lent);
  reserved_ = {written_, 0, 0, lent.offset, head_bytes, lent.data.size(), 0};
}

uint64_t SensoryRingWriter::publish(uint64_t entities, Time first, SteadyTime now) {
  const size_t slot = layout_.slot_of(written_);
  const uint64_t said[] = {written_,
                           entities,
                           static_cast<uint64_t>(now.time_since_epoch().count()),
                           reserved_.offset,
                           reserved_.head_bytes,
                           reserved_.data_bytes,
                           static_cast<uint64_t>(to_ns(first))};
  for (size_t i = 0; i < std::size(said); ++i)
    set(slot + i * sizeof(uint64_t), said[i], __ATOMIC_RELAXED);
  const size_t end = reserved_.offset + to_whole_lines(reserved_.head_bytes + reserved_.data_bytes);
  live_.push_back({written_, entities, reserved_.offset, end - reserved_.offset, now});
  occupy(reserved_.offset, end);
  snapshots_ += static_cast<uint64_t>(std::popcount(entities));
  set(offsetof(SensoryLayout::Counts, written), written_ + 1, __ATOMIC_RELEASE);
  // Behind the entry, so that whoever counts knows of it what it counts.
  set(offsetof(SensoryLayout::Counts, snapshots), snapshots_, __ATOMIC_RELEASE);
  // Before the look at who attends: whoever opens attention looks in the other order, so that one
  // of both sees the other.
  std::atomic_thread_fence(std::memory_order_seq_cst);
  return written_++;
}

bool SensoryRingWriter::is_attended(uint64_t entities) const {
  return (control_.attended.load(std::memory_order_seq_cst) & entities) != 0;
}

bool SensoryRingWriter::is_closed() const {
  return control_.is_closed.load(std::memory_order_seq_cst) != 0;
}

}  // namespace engram::server
