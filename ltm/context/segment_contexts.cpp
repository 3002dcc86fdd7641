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

/// The context of an entity in a segment's index; nothing if it is not there or damaged.
std::optional<EntityContext> indexed(StoreReader& store, uint32_t segment, const MemoryId& entity) {
  const SegmentInfo& info = store.manifest().segments[segment];
  const auto bytes = read_segment_index(store.path(), info, kContextIndex);
  if (!bytes.ok()) return std::nullopt;
  auto context = unpack_context(bytes->bytes(), entity);
  if (context.ok()) return *std::move(context);
  log::warning("store '{}': index of '{}': {}", store.path().string(), info.file,
               context.status().message());
  return std::nullopt;
}

/// Gathers the context of one entity.
class Gathering {
 public:
  Gathering(StoreReader& store, const MemoryId& entity, const DecodeLatents& decode)
      : store_(store), entity_(entity), decode_(decode) {}

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
    EntityContext read = std::move(reader()).take();
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
    const auto [there, is_new] = indexes_.try_emplace(segment);
    if (is_new) there->second.context = indexed(store_, segment, entity_);
    return there->second;
  }

  ContextReader& reader() {
    if (!reader_) {
      const idf::Type* type = store_.manifest().types.of_entity(entity_);
      reader_.emplace(type == nullptr ? std::nullopt : std::optional(*type));
    }
    return *reader_;
  }

  void read(const SnapshotEntry& entry) {
    const idf::Type* type = store_.manifest().types.of_entity(entity_);
    if (type != nullptr && !tells_) tells_ = tells_context(*type);
    if (tells_ && !*tells_) {
      reader().add(entry.time, {});
      return;
    }
    const auto values = values_of(entry);
    if (!values.ok())
      log::warning("'{}': its places and links cannot be read: {}",
                   entity_.at(entry.time).to_string(), values.status().message());
    reader().add(entry.time, values.ok() ? *values : std::vector<InstanceResult>());
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
  const MemoryId& entity_;
  const DecodeLatents& decode_;
  std::map<uint32_t, Indexed> indexes_;
  std::optional<ContextReader> reader_;
  std::optional<bool> tells_;  ///< Whether its type can have places, links or spans, if it has one.
  /// Each snapshot's context and its row there; null: in what was read.
  std::vector<std::pair<const EntityContext*, uint32_t>> rows_;
  uint32_t read_ = 0;
};

/// The contexts of what a segment has, as far as its index is the one to have them.
Result<SegmentContexts> contexts_of_segment(StoreReader& store, uint32_t segment,
                                            const DecodeLatents& decode,
                                            const std::stop_token& stop) {
  SegmentContexts contexts;
  for (const SegmentEntity& entity : store.manifest().segments[segment].entities) {
    if (stop.stop_requested()) return cancelled("indexing places and links");
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store.timeline(entity.id));
    Gathering gathering(store, entity.id, decode);
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

Result<EntityContext> context_in_store(StoreReader& store, const MemoryId& entity,
                                       const DecodeLatents& decode) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* const entries, store.index(entity));
  Gathering gathering(store, entity, decode);
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
