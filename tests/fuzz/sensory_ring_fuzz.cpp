// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/sensory_ring.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "tests/fuzz/fuzz_check.h"

/// Whatever a provider writes into its ring: no more entries than slots, and each that is found
/// lies in the ring. The memory ends where the ring does, so that a sanitizer sees a read beyond
/// it.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram;
  using namespace engram::server;
  std::vector<uint64_t> words(kMinSensoryRing / sizeof(uint64_t));
  std::memcpy(words.data(), data, std::min(size, kMinSensoryRing));
  const auto memory = std::as_bytes(std::span<const uint64_t>(words));
  const SensoryRingReader reader(memory);
  const SensoryLayout layout(memory.size());
  const SensoryRingReader::Range range = reader.entries();
  ENGRAM_CHECK(range.first <= range.end && range.end - range.first <= layout.slots(),
               "entries from {} to {} of {} slots", range.first, range.end, layout.slots());
  std::vector<std::byte> copied(memory.size());
  for (uint64_t sequence = range.first; sequence < range.end; ++sequence) {
    const auto entry = reader.find(sequence);
    if (!entry) continue;
    const uint64_t bytes = entry->head_bytes + entry->data_bytes;
    ENGRAM_CHECK(entry->offset >= layout.data_begin() && bytes <= memory.size() &&
                     entry->offset + bytes <= memory.size(),
                 "an entry of {} bytes at {}", bytes, entry->offset);
    const std::span<std::byte> to = std::span(copied).first(bytes);
    ENGRAM_CHECK(reader.copy(*entry, 0, to), "entry {} cannot be copied", sequence);
    ENGRAM_CHECK(std::ranges::equal(to, memory.subspan(entry->offset, bytes)), "another entry");
    ENGRAM_CHECK(!reader.copy(*entry, bytes, std::span(copied).first(1)), "beyond its end");
  }
  return 0;
}
