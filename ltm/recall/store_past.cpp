// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/store_past.h"

#include <algorithm>
#include <functional>

#include "ltm/recall/timeline_moments.h"

namespace engram::ltm {

/// Shares the reader of its generation, so it can be read on after the store was renewed.
class StorePast::Entity final : public EntityPast {
 public:
  Entity(StorePast& past, MemoryId id, Timeline& timeline)
      : past_(past),
        reader_(past.reader_),
        id_(std::move(id)),
        timeline_(timeline),
        moments_(timeline) {}

  Result<std::optional<Time>> first() override { return moments_.first(); }
  Result<std::optional<Time>> last() override { return moments_.last(); }
  Result<std::optional<Time>> at_or_after(Time time) override { return moments_.at_or_after(time); }
  Result<std::optional<Time>> at_or_before(Time time) override {
    return moments_.at_or_before(time);
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return moments_.nth(index); }
  Result<uint64_t> count() override { return timeline_.count(); }

  Result<RecalledSnapshot> read(Time moment, Prefer prefer) override {
    const MemoryId id = id_.at(moment);
    if (auto decoded = past_.decoded_.find(id, prefer)) {
      ++past_.from_decoded_;
      return RecalledSnapshot{*std::move(decoded)};
    }
    ENGRAM_ASSIGN_OR_RETURN(const SnapshotEntry entry, entry_at(moment));
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult decoded, reader_->read(id_, entry, prefer));
    if (past_.keeps_decoded_) past_.decoded_.put(id, prefer, decoded);
    ++past_.decodings_;
    past_.decoded_bytes_ = past_.decoded_.bytes();
    return RecalledSnapshot{std::move(decoded)};
  }

  Result<RecalledSnapshot> name(Time moment, Prefer prefer) override {
    ENGRAM_ASSIGN_OR_RETURN(const SnapshotEntry entry, entry_at(moment));
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult named, reader_->name(id_, entry, prefer));
    return RecalledSnapshot{std::move(named)};
  }

  Result<SharedContext> context(const std::optional<idf::Type>& /*type*/) override {
    return past_.context_of(reader_, id_);
  }

 private:
  Result<SnapshotEntry> entry_at(Time moment) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline_.at_or_before(moment));
    if (!entry || entry->time != moment)
      return unavailable("'{}': was here a moment ago", id_.at(moment).to_string());
    return *entry;
  }

  StorePast& past_;
  const std::shared_ptr<PastReader> reader_;
  const MemoryId id_;
  Timeline& timeline_;
  TimelineMoments moments_;
};

StorePast::StorePast(std::unique_ptr<StoreReader> store, ModelLoader loader, const Options& options)
    : options_(options),
      models_(std::make_shared<LoadedModels>(std::move(loader))),
      reader_(std::make_shared<PastReader>(std::move(store), models_)),
      decoded_(options.max_decoded_bytes) {}

Result<std::unique_ptr<StorePast>> StorePast::open(const std::filesystem::path& store,
                                                   ModelLoader loader, const Options& options) {
  // The mark is taken before opening, so a change between the two is noticed later.
  StoreMark mark = look_at_store(store);
  ENGRAM_ASSIGN_OR_RETURN(auto reader, StoreReader::open(store));
  auto past = std::make_unique<StorePast>(std::move(reader), std::move(loader), options);
  past->mark_ = std::move(mark);
  return past;
}

std::string StorePast::name() const {
  return "store '" + reader_->store().path().string() + "'";
}

std::vector<MemoryId> StorePast::matching(const Query& query) {
  std::vector<MemoryId> matching;
  if (const auto names = query.named_entities()) {
    for (const MemoryId& named : *names)
      if (store().has(named)) matching.push_back(named);
    return matching;
  }
  for (MemoryId& entity : store().entities())
    if (query.matches(entity)) matching.push_back(std::move(entity));
  return matching;
}

Result<std::unique_ptr<EntityPast>> StorePast::of(const MemoryId& entity) {
  if (!store().has(entity)) return std::unique_ptr<EntityPast>();
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store().timeline(entity));
  return std::unique_ptr<EntityPast>(std::make_unique<Entity>(*this, entity, *timeline));
}

Result<SharedContext> StorePast::context_of(const std::shared_ptr<PastReader>& reader,
                                            const MemoryId& entity) {
  const bool is_newest = reader == reader_;
  if (is_newest)
    if (const auto known = contexts_.find(entity); known != contexts_.end()) return known->second;
  if (is_newest && !indexes_) indexes_ = std::make_unique<ContextIndexes>(reader->store());
  ContextIndexes of_earlier(reader->store());
  ENGRAM_ASSIGN_OR_RETURN(
      EntityContext context,
      context_in_store(reader->store(), is_newest ? *indexes_ : of_earlier, entity,
                       [&reader](const MemoryId& id, const SnapshotEntry& entry) {
                         return reader->read(id, entry, Prefer::kLatent);
                       }));
  auto shared = std::make_shared<const EntityContext>(std::move(context));
  if (!is_newest) return SharedContext(std::move(shared));
  const size_t bytes = shared->held_bytes();
  if (context_bytes_ + bytes > kMaxContextCacheBytes) clear_contexts();
  if (bytes <= kMaxContextCacheBytes) {
    contexts_[entity] = shared;
    context_bytes_ += bytes;
  }
  return SharedContext(std::move(shared));
}

void StorePast::clear_contexts() {
  contexts_.clear();
  context_bytes_ = 0;
}

std::optional<idf::Type> StorePast::type_of(const MemoryId& entity) const {
  const idf::Type* type = reader_->store().manifest().types.of_entity(entity);
  return type == nullptr ? std::nullopt : std::optional(*type);
}

std::vector<Engine> StorePast::engines_of(const LoadedModel& model, const ModelInfo& info) {
  std::vector<Engine> engines;
  if (model.predictor) engines.push_back({model.predictor.get(), info.name()});
  if (model.copy_last) engines.push_back({model.copy_last.get(), ""});
  return engines;
}

Result<std::vector<Engine>> StorePast::models(const MemoryId& entity) {
  const ModelInfo* newest = store().manifest().newest_model(entity);
  if (newest == nullptr || !models_->has_loader()) return std::vector<Engine>{};
  const auto loaded = reader_->load(*newest);
  if (is_damage(loaded.status())) return std::vector<Engine>{};
  ENGRAM_RETURN_IF_ERROR(loaded.status());
  return engines_of(**loaded, *newest);
}

Result<std::vector<Engine>> StorePast::models_trained_until(const MemoryId& entity, Time now) {
  std::vector<const ModelInfo*> versions;
  for (const ModelInfo& model : store().manifest().models)
    if (model.entity == entity) versions.push_back(&model);
  std::ranges::sort(versions, std::greater(), &ModelInfo::version);
  if (!models_->has_loader()) versions.clear();
  for (const ModelInfo* version : versions) {
    const auto loaded = reader_->load(*version);
    if (is_damage(loaded.status())) continue;
    ENGRAM_RETURN_IF_ERROR(loaded.status());
    const std::optional<Time>& until = (*loaded)->trained_until;
    if (until && *until <= now) return engines_of(**loaded, *version);
  }
  return std::vector<Engine>{};
}

Status StorePast::renew() {
  StoreMark mark = look_at_store(reader_->store().path());
  ENGRAM_ASSIGN_OR_RETURN(auto store, StoreReader::open(reader_->store().path()));
  indexes_.reset();
  clear_contexts();
  reader_ = std::make_shared<PastReader>(std::move(store), models_);
  mark_ = std::move(mark);
  ++opened_;
  return {};
}

Status StorePast::start_anew() {
  forget_decoded();
  models_->clear();
  return renew();
}

Status StorePast::follow() {
  if (!options_.follows_changes || look_at_store(reader_->store().path()) == mark_) return {};
  forget_decoded();
  return renew();
}

bool StorePast::is_outdated() const {
  const StoreMark now = look_at_store(reader_->store().path());
  // A manifest that is missing was not published.
  return now.manifest != StoreMark().manifest && now.manifest != mark_.manifest;
}

void StorePast::forget_decoded(const MemoryId& snapshot) {
  decoded_.erase(snapshot);
  decoded_bytes_ = decoded_.bytes();
}

void StorePast::forget_decoded() {
  decoded_.clear();
  decoded_bytes_ = 0;
}

StorePast::Counters StorePast::counters() const {
  return {opened_,        decodings_,         from_decoded_,
          decoded_bytes_, models_->damaged(), models_->substituted()};
}

}  // namespace engram::ltm
