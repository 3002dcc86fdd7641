// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sensory_ring.h"

#include <algorithm>
#include <cstring>

#include "ltm/core/check.h"

namespace engram::server {

namespace {

/// One slot for so many bytes of a ring, but at least and at most so many: an entry of small
/// snapshots takes about that much.
constexpr uint64_t kBytesOfASlot = 4096;
constexpr uint64_t kMinSlots = 64;
constexpr uint64_t kMaxSlots = 16384;

}  // namespace

SensoryLayout::SensoryLayout(size_t bytes)
    : bytes_(bytes), slots_(std::clamp<uint64_t>(bytes / kBytesOfASlot, kMinSlots, kMaxSlots)) {
  ENGRAM_CHECK(bytes >= kMinSensoryRing, "a ring of {} bytes", bytes);
}

SensoryRingReader::SensoryRingReader(std::span<const std::byte> memory)
    : memory_(memory), layout_(memory.size()) {
  ENGRAM_CHECK(reinterpret_cast<uintptr_t>(memory.data()) % alignof(uint64_t) == 0,
               "a ring begins at {}", static_cast<const void*>(memory.data()));
}

/// Another process may write it at the same time.
uint64_t SensoryRingReader::word(size_t offset) const {
  const auto* at = reinterpret_cast<const uint64_t*>(memory_.data() + offset);
  return __atomic_load_n(at, __ATOMIC_ACQUIRE);
}

SensoryRingReader::Range SensoryRingReader::entries() const {
  const uint64_t end = word(offsetof(SensoryLayout::Counts, written));
  const uint64_t valid = word(offsetof(SensoryLayout::Counts, valid_from));
  // Slots are used again, so no more entries than slots can be there, whatever is said.
  const uint64_t first = end > layout_.slots() ? end - layout_.slots() : 0;
  return {std::min(std::max(first, valid), end), end};
}

std::optional<SensoryEntry> SensoryRingReader::find(uint64_t sequence) const {
  const size_t slot = layout_.slot_of(sequence);
  const auto said = [&](size_t number) { return word(slot + number * sizeof(uint64_t)); };
  SensoryEntry entry{said(0), said(1), static_cast<int64_t>(said(2)), said(3),
                     said(4), said(5), static_cast<int64_t>(said(6))};
  const Range readable = entries();
  if (sequence < readable.first || sequence >= readable.end || entry.sequence != sequence)
    return std::nullopt;
  // Each is compared with what there is before they are added.
  const uint64_t begin = layout_.data_begin();
  const uint64_t end = layout_.data_end();
  if (entry.offset < begin || entry.offset > end || entry.head_bytes > end - entry.offset ||
      entry.data_bytes > end - entry.offset - entry.head_bytes)
    return std::nullopt;
  return entry;
}

bool SensoryRingReader::copy(const SensoryEntry& entry, uint64_t offset,
                             std::span<std::byte> to) const {
  const uint64_t bytes = entry.head_bytes + entry.data_bytes;
  if (offset > bytes || to.size() > bytes - offset) return false;
  if (!to.empty()) std::memcpy(to.data(), memory_.data() + entry.offset + offset, to.size());
  // A provider says that an entry is overwritten before it does so: if it does not say so after the
  // copy, the copy is whole.
  std::atomic_thread_fence(std::memory_order_acquire);
  const Range readable = entries();
  return entry.sequence >= readable.first && entry.sequence < readable.end;
}

uint64_t SensoryRingReader::snapshots() const {
  return word(offsetof(SensoryLayout::Counts, snapshots));
}

uint64_t SensoryRingReader::crowded_out() const {
  return word(offsetof(SensoryLayout::Counts, crowded_out));
}

}  // namespace engram::server
