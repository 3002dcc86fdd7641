// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ltm/core/mutex.h"
#include "memory/live/event_hub.h"
#include "server/sharing/shared_pool.h"
#include "server/wire/wire_block.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

/// A committed snapshot in the wire forms that subscribers ask for; each form is made once, for
/// all.
///
/// Threading: thread-safe.
class WireEvent final : public memory::CommitEvent {
 public:
  using memory::CommitEvent::CommitEvent;

  const WireBytes& with_data() {
    const MutexLock lock(mutex_);
    if (!data_) data_ = to_wire(*snapshot, true);
    return *data_;
  }
  /// The form that names a block of the pool in place of the data.
  struct Shared {
    BlockRef block;
    WireBytes bytes;
  };
  /// Returns null if the data are not in one block of the pool, or are small.
  const Shared* shared(const SharedPool& pool) {
    const MutexLock lock(mutex_);
    if (!shared_) shared_ = make_shared(pool);
    return *shared_ ? &**shared_ : nullptr;
  }
  const WireBytes& ids_only() {
    const MutexLock lock(mutex_);
    if (!ids_) ids_ = to_wire(*snapshot, false);
    return *ids_;
  }

 private:
  /// Smaller data are sent inline: naming a block costs more.
  static constexpr size_t kSharedBytes = size_t{16} << 10;

  [[nodiscard]] std::optional<Shared> make_shared(const SharedPool& pool) const {
    size_t bytes = 0;
    std::vector<uint64_t> offsets;
    std::optional<BlockRef> block;
    for (const Buffer& data : snapshot->encoded) {
      const auto located = pool.locate(data.bytes());
      if (!located || (block && *block != located->block)) return std::nullopt;
      block = located->block;
      offsets.push_back(located->offset);
      bytes += data.size();
    }
    if (!block || bytes < kSharedBytes) return std::nullopt;
    return Shared{*block, to_wire_in_block(*snapshot, to_message(*block), offsets)};
  }

  Mutex mutex_;  ///< A mutex, because call_once() enters the kernel.
  std::optional<WireBytes> data_ ENGRAM_GUARDED_BY(mutex_);
  std::optional<WireBytes> ids_ ENGRAM_GUARDED_BY(mutex_);
  std::optional<std::optional<Shared>> shared_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::server
