// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/segment_contexts.h"

#include <map>

#include "ltm/context/read_context.h"
#include "ltm/context/stored_context.h"
#include "ltm/core/log.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// The segment whose index has a snapshot: that of its latents, which stay when the recorded form
/// goes; nothing for what is in journals.
std::optional<uint32_t> segment_of_context(const SnapshotEntry& entry) {
  if (entry.latent) return entry.latent->source;
  if (entry.recorded && entry.recorded->rows > 0) return entry.recorded->source;
  return std::nullopt;
}

/// Gathers the context of one entity.
class Gathering {
 public:
  Gathering(StoreReader& store, ContextIndexes& indexes, const MemoryId& entity,
            const DecodeLatents& decode)
      : store_(store),
        indexes_(indexes),
        entity_(entity),
        decode_(decode),
        type_(store.manifest().types.of_entity(entity)),
        tells_(type_ == nullptr || tells_context(*type_)),
        reader_(type_ == nullptr ? std::nullopt : std::optional(*type_)) {}

  /// Adds a snapshot, later than those before.
  void add(const SnapshotEntry& entry) {
    for (const auto& form : {entry.latent, entry.recorded}) {
      if (!form || form->rows == 0) continue;
      Indexed& there = index_of(form->source);
      if (const auto row = there.find(entry.time)) {
        rows_.push_back({&*there.context, *row});
        return;
      }
    }
    rows_.push_back({nullptr, read_});
    ++read_;
    read(entry);
  }

  EntityContext take() && {
    if (unread_ > 1)
      log::warning("'{}': places and links of {} more snapshots cannot be read",
                   entity_.to_string(), unread_ - 1);
    EntityContext read = std::move(reader_).take();
    // A single source needs no copy.
    if (read_ == rows_.size()) return read;
    ContextMerger merger;
    for (const auto& [from, row] : rows_) merger.add(from == nullptr ? read : *from, row);
    return std::move(merger).take();
  }

 private:
  struct Indexed {
    std::optional<EntityContext> context;
    uint32_t next = 0;

    /// Moments come in order, so that the next one is found at once.
    std::optional<uint32_t> find(Time time) {
      if (!context) return std::nullopt;
      while (next < context->times.size() && context->times[next] < time) ++next;
      if (next < context->times.size() && context->times[next] == time) return next++;
      return std::nullopt;
    }
  };

  Indexed& index_of(uint32_t segment) {
    const auto [there, is_new] = found_.try_emplace(segment);
    if (is_new) there->second.context = indexes_.find(segment, entity_);
    return there->second;
  }

  void read(const SnapshotEntry& entry) {
    if (!tells_) {
      reader_.add(entry.time, {});
      return;
    }
    const auto values = values_of(entry);
    // One is named: there may be as many as there are snapshots.
    if (!values.ok() && unread_++ == 0)
      log::warning("'{}': its places and links cannot be read: {}",
                   entity_.at(entry.time).to_string(), values.status().message());
    reader_.add(entry.time, values.ok() ? *values : std::vector<InstanceResult>());
  }

  Result<std::vector<InstanceResult>> values_of(const SnapshotEntry& entry) {
    std::vector<InstanceResult> instances;
    if (!entry.recorded) {
      if (!decode_) return failed_precondition("only latents are left, and nothing decodes them");
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult decoded, decode_(entity_, entry));
      return std::move(decoded.instances);
    }
    ENGRAM_ASSIGN_OR_RETURN(PackedSnapshot packed, store_.read_values(entity_, entry));
    for (PackedInstance& instance : packed.instances) {
      InstanceResult& added = instances.emplace_back();
      added.index = static_cast<int32_t>(instances.size() - 1);
      added.data = std::move(instance.value.rest);
    }
    return instances;
  }

  StoreReader& store_;
  ContextIndexes& indexes_;
  const MemoryId& entity_;
  const DecodeLatents& decode_;
  const idf::Type* const type_;  ///< Null if it is not known.
  const bool tells_;             ///< Whether its values can have places, links or spans.
  ContextReader reader_;
  std::map<uint32_t, Indexed> found_;  ///< By segment.
  size_t unread_ = 0;                  ///< Snapshots that cannot be read.
  /// Each snapshot's context and its row there; null: in what was read.
  std::vector<std::pair<const EntityContext*, uint32_t>> rows_;
  uint32_t read_ = 0;
};

/// The contexts of what a segment has, as far as its index is the one to have them.
Result<SegmentContexts> contexts_of_segment(StoreReader& store, uint32_t segment,
                                            const DecodeLatents& decode,
                                            const std::stop_token& stop) {
  SegmentContexts contexts;
  ContextIndexes indexes(store);
  for (const SegmentEntity& entity : store.manifest().segments[segment].entities) {
    if (stop.stop_requested()) return cancelled("indexing places and links");
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store.timeline(entity.id));
    Gathering gathering(store, indexes, entity.id, decode);
    ENGRAM_RETURN_IF_ERROR(
        timeline->for_each(entity.first, entity.last, [&](const SnapshotEntry& entry) -> Status {
          if (segment_of_context(entry) == segment) gathering.add(entry);
          return {};
        }));
    contexts.emplace_back(entity.id, std::move(gathering).take());
  }
  return contexts;
}

}  // namespace

ContextIndexes::File& ContextIndexes::file(uint32_t segment) {
  if (const auto known = files_.find(segment); known != files_.end()) return known->second;
  File read;
  const SegmentInfo& info = store_.manifest().segments[segment];
  if (auto bytes = read_segment_index(store_.path(), info, kContextIndex); bytes.ok()) {
    read.bytes = *std::move(bytes);
    if (auto contexts = list_contexts(read.bytes.bytes()); contexts.ok())
      read.contexts = *std::move(contexts);
    else
      log::warning("store '{}': index of '{}': {}", store_.path().string(), info.file,
                   contexts.status().message());
  }
  if (kept_bytes_ + read.bytes.size() > kMaxKeptBytes) {
    files_.clear();
    kept_bytes_ = 0;
  }
  kept_bytes_ += read.bytes.size();
  return files_.emplace(segment, std::move(read)).first->second;
}

std::optional<EntityContext> ContextIndexes::find(uint32_t segment, const MemoryId& entity) {
  const File& index = file(segment);
  const auto packed = index.contexts.find(entity.to_string());
  if (packed == index.contexts.end()) return std::nullopt;
  auto context = unpack_listed(packed->second);
  if (context.ok()) return *std::move(context);
  log::warning("store '{}': index of '{}': {}", store_.path().string(),
               store_.manifest().segments[segment].file, context.status().message());
  return std::nullopt;
}

Result<EntityContext> context_in_store(StoreReader& store, ContextIndexes& indexes,
                                       const MemoryId& entity, const DecodeLatents& decode) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* const entries, store.index(entity));
  Gathering gathering(store, indexes, entity, decode);
  for (const SnapshotEntry& entry : *entries) gathering.add(entry);
  return std::move(gathering).take();
}

Result<uint64_t> index_segment(StoreReader& store, uint32_t segment, const DecodeLatents& decode,
                               const std::stop_token& stop) {
  const SegmentInfo& info = store.manifest().segments[segment];
  ENGRAM_ASSIGN_OR_RETURN(const SegmentContexts contexts,
                          contexts_of_segment(store, segment, decode, stop));
  const Status written = edit_segment_index(
      store.path(), info, kContextIndex,
      [&contexts](std::span<const std::byte>) { return pack_contexts(contexts); });
  // It was replaced meanwhile, and the next job indexes what replaced it.
  if (written.code() == StatusCode::kNotFound) return uint64_t{0};
  ENGRAM_RETURN_IF_ERROR(written);
  uint64_t snapshots = 0;
  for (const auto& [entity, context] : contexts) snapshots += context.times.size();
  return snapshots;
}

Result<ContextIndexing> index_contexts(StoreReader& store, const DecodeLatents& decode,
                                       const std::function<bool()>& is_over,
                                       const ProgressSink& progress, const std::stop_token& stop) {
  ContextIndexing report;
  const auto& segments = store.manifest().segments;
  for (uint32_t i = 0; i < segments.size(); ++i) {
    if (read_segment_index(store.path(), segments[i], kContextIndex).ok()) continue;
    if (is_over && is_over()) {
      ++report.left;
      continue;
    }
    if (progress) progress({"index places and links", i, segments.size(), "", -1});
    const auto indexed = index_segment(store, i, decode, stop);
    if (const StatusCode code = indexed.status().code();
        code == StatusCode::kCancelled || code == StatusCode::kResourceExhausted)
      return indexed.status();
    if (!indexed.ok()) {
      log::warning("store '{}': '{}' has no index of places and links: {}", store.path().string(),
                   segments[i].file, indexed.status().message());
      continue;
    }
    ++report.segments;
    report.snapshots += *indexed;
  }
  if (progress && report.segments > 0 && report.left == 0)
    progress({"index places and links", segments.size(), segments.size(), "", -1});
  return report;
}

}  // namespace engram::ltm
