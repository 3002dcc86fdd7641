// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stop_token>

#include "ltm/context/entity_context.h"
#include "ltm/context/stored_context.h"
#include "ltm/core/buffer.h"
#include "ltm/core/progress.h"
#include "ltm/memory/result.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Decodes a snapshot of which only latents are left.
using DecodeLatents =
    std::function<Result<SnapshotResult>(const MemoryId& entity, const SnapshotEntry& entry)>;

/// The indexes of places and links of one generation of a store. Those that were read last are
/// kept: one file has all entities of a segment, and they are asked for one after the other.
///
/// Threading: one thread. The store must outlive it.
class ContextIndexes {
 public:
  explicit ContextIndexes(StoreReader& store) : store_(store) {}

  /// What the index of a segment has of an entity; nothing if there is no index, if it is damaged,
  /// or if it has nothing.
  std::optional<EntityContext> find(uint32_t segment, const MemoryId& entity);

 private:
  struct File {
    Buffer bytes;
    PackedContexts contexts;  ///< In `bytes`.
  };
  static constexpr size_t kMaxKeptBytes = size_t{64} << 20;

  File& file(uint32_t segment);

  StoreReader& store_;
  std::map<uint32_t, File> files_;
  size_t kept_bytes_ = 0;
};

/// The context of an entity in one generation of a store: from the indexes of its segments, and of
/// what they do not have from its values. A snapshot that is damaged or cannot be decoded has no
/// places and links.
/// Errors: kNotFound if there is no such entity; those of StoreReader::index.
/// Complexity: O(n) with indexes; without them all values of the entity are read.
Result<EntityContext> context_in_store(StoreReader& store, ContextIndexes& indexes,
                                       const MemoryId& entity, const DecodeLatents& decode);

/// Makes the index of one segment, a position in the manifest's list (checked). Returns how many
/// snapshots are in it.
/// Errors: kCancelled on `stop`; kDataLoss, kUnavailable, kResourceExhausted.
Result<uint64_t> index_segment(StoreReader& store, uint32_t segment, const DecodeLatents& decode,
                               const std::stop_token& stop);

/// What index_contexts() did.
struct ContextIndexing {
  uint64_t segments = 0;   ///< That are indexed now and were not.
  uint64_t snapshots = 0;  ///< That are in these indexes.
  uint64_t left = 0;       ///< Segments without an index, because time was over.
};

/// Makes the index of places and links of each segment that has none. It may run beside a live
/// writer and other jobs; a kill loses the index at hand.
/// Errors: kCancelled on `stop`; kUnavailable, kResourceExhausted. A segment that cannot be read is
/// logged and left out.
/// Source: docs/query.md, "Places"; docs/format.md, "Indexes".
Result<ContextIndexing> index_contexts(StoreReader& store, const DecodeLatents& decode,
                                       const std::function<bool()>& is_over,
                                       const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::ltm
