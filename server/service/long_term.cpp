// SPDX-License-Identifier: Apache-2.0
#include "server/service/long_term.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <shared_mutex>

#include "ltm/idf/binary.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/past_reader.h"
#include "server/service/decoded_cache.h"
#include "server/service/joined_moments.h"

namespace engram::server {

using ltm::MemoryId;

namespace {

/// A model stays loaded when the store is read anew.
class SharedEncoder final : public ltm::Encoder {
 public:
  explicit SharedEncoder(std::shared_ptr<ltm::LoadedModel> model) : model_(std::move(model)) {}

  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values) override {
    return model_->encoder->encode(values);
  }
  Result<std::vector<idf::Data>> decode(std::span<const ltm::Latent> latents) override {
    return model_->encoder->decode(latents);
  }

 private:
  std::shared_ptr<ltm::LoadedModel> model_;
};

/// What the store has of an entity.
struct Known {
  std::optional<Time> until;
  uint64_t recorded_at = 0;  ///< Number of the recording that changed it last.
};

void leave_instances(ltm::SnapshotResult& snapshot, const std::vector<int32_t>& instances) {
  if (instances.empty()) return;
  std::erase_if(snapshot.instances, [&instances](const ltm::InstanceResult& instance) {
    return !std::ranges::binary_search(instances, instance.index);
  });
}

/// About what a moment costs beside its values.
constexpr size_t kMomentBytes = 256;

size_t bytes_of(const ltm::SnapshotResult& snapshot) {
  size_t bytes = kMomentBytes;
  for (const ltm::InstanceResult& instance : snapshot.instances)
    bytes += idf::encoded_size(instance.data);
  return bytes;
}

}  // namespace

struct LongTerm::State {
  State(Options given, ltm::ModelLoader model_loader)
      : options(std::move(given)),
        loader(std::move(model_loader)),
        cache(options.most_decoded_bytes),
        accesses(options.store, {}) {}

  Options options;
  ltm::ModelLoader loader;

  std::mutex writing;  ///< Taken before the others.
  std::optional<ltm::Recorder> recorder;
  bool is_closed = false;

  mutable std::shared_mutex known_mutex;
  std::map<MemoryId, Known> known;
  uint64_t recordings = 0;

  std::recursive_mutex reading;  ///< Taken before `known_mutex`.
  std::unique_ptr<ltm::PastReader> past;
  uint64_t past_at = 0;  ///< Number of the last recording that it sees.
  std::map<std::filesystem::path, std::shared_ptr<ltm::LoadedModel>> models;
  DecodedCache cache;
  ltm::AccessLog accesses;  ///< Of what was read from here.

  mutable std::mutex counting;
  Counters counts;
  std::vector<MemoryId> replaced;  ///< What may be in the cache, and has been recorded anew.

  Result<std::shared_ptr<ltm::LoadedModel>> model(const std::filesystem::path& path) {
    if (const auto loaded = models.find(path); loaded != models.end()) return loaded->second;
    ENGRAM_ASSIGN_OR_RETURN(auto loaded, loader(path));
    return models.emplace(path, std::make_shared<ltm::LoadedModel>(std::move(loaded)))
        .first->second;
  }

  Result<ltm::LoadedModel> load(const std::filesystem::path& path) {
    ltm::LoadedModel shared;
    ENGRAM_ASSIGN_OR_RETURN(auto model, this->model(path));
    shared.encoder = std::make_unique<SharedEncoder>(std::move(model));
    return shared;
  }

  Status open_past() {
    uint64_t at = 0;
    {
      const std::shared_lock lock(known_mutex);
      at = recordings;
    }
    ENGRAM_ASSIGN_OR_RETURN(auto store, ltm::StoreReader::open(options.store));
    ltm::ModelLoader shared;
    if (loader) shared = [this](const std::filesystem::path& path) { return load(path); };
    past = std::make_unique<ltm::PastReader>(std::move(store), std::move(shared));
    past_at = at;
    const std::scoped_lock lock(counting);
    ++counts.opened;
    return {};
  }

  [[nodiscard]] uint64_t recorded_at(const MemoryId& entity) const {
    const std::shared_lock lock(known_mutex);
    const auto found = known.find(entity);
    return found == known.end() ? 0 : found->second.recorded_at;
  }

  void forget_replaced() {
    const std::scoped_lock lock(counting);
    for (const MemoryId& id : replaced) cache.erase(id);
    replaced.clear();
    counts.decoded_bytes = cache.bytes();
  }

  /// Null where the store has nothing of the entity.
  Result<ltm::Timeline*> timeline(const MemoryId& entity) {
    forget_replaced();
    if (!past || recorded_at(entity) > past_at) ENGRAM_RETURN_IF_ERROR(open_past());
    auto found = past->store().timeline(entity);
    if (found.ok()) return *found;
    if (found.status().code() == StatusCode::kNotFound) return nullptr;
    return found.status();
  }

  Result<ltm::SnapshotResult> read(const MemoryId& entity, ltm::Timeline& timeline, Time time) {
    const MemoryId id = entity.at(time);
    if (auto decoded = cache.find(id)) {
      const std::scoped_lock lock(counting);
      ++counts.from_decoded;
      return *std::move(decoded);
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(time));
    if (!entry || entry->time != time)
      return unavailable("'{}': was here a moment ago", id.to_string());
    const auto prefer = options.prefers_latents ? ltm::Prefer::kLatent : ltm::Prefer::kRecorded;
    ENGRAM_ASSIGN_OR_RETURN(auto decoded, past->read(entity, *entry, prefer));
    cache.put(id, decoded);
    const std::scoped_lock lock(counting);
    ++counts.decoded;
    counts.decoded_bytes = cache.bytes();
    return decoded;
  }

  Result<ltm::SnapshotResult> name(const MemoryId& entity, ltm::Timeline& timeline, Time time) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(time));
    if (!entry || entry->time != time)
      return unavailable("'{}': was here a moment ago", entity.at(time).to_string());
    const auto prefer = options.prefers_latents ? ltm::Prefer::kLatent : ltm::Prefer::kRecorded;
    return past->name(entity, *entry, prefer);
  }

  Result<Answer> answer(const ltm::Query& query, const MemoryId& entity,
                        std::span<const SharedSnapshot> held, size_t& most_bytes) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * stored, timeline(entity));
    JoinedMoments moments(held, stored);
    ENGRAM_ASSIGN_OR_RETURN(auto selection,
                            ltm::select_snapshots(query.snapshots_of(entity), moments));
    Answer answer{{entity, {}}, {}};
    for (ltm::SelectedSnapshot& selected : selection) {
      if (selected.is_future) {
        answer.future.push_back(selected.time);
        continue;
      }
      ServedSnapshot served;
      if (SharedSnapshot found = moments.find(selected.time)) {
        served = serve(std::move(found), selected.instances, query.is_ids_only());
      } else {
        ENGRAM_CHECK(stored != nullptr, "'{}' was selected", entity.to_string());
        ENGRAM_ASSIGN_OR_RETURN(served.answer, query.is_ids_only()
                                                   ? name(entity, *stored, selected.time)
                                                   : read(entity, *stored, selected.time));
        leave_instances(served.answer, selected.instances);
        const size_t bytes = bytes_of(served.answer);
        if (bytes > most_bytes)
          return resource_exhausted(
              "'{}' asks for more than the {} bytes that an answer may have: found {} moments of "
              "'{}', needs fewer, or IDs alone",
              query.to_string(), options.most_answer_bytes, selection.size(), entity.to_string());
        most_bytes -= bytes;
      }
      if (!served.answer.instances.empty()) answer.entity.snapshots.push_back(std::move(served));
    }
    return answer;
  }

  /// All at once; where one of them cannot be stored at all, each alone.
  Status record(std::span<const SharedSnapshot> snapshots, std::vector<Refused>& refused) {
    ltm::Commit all;
    for (const SharedSnapshot& snapshot : snapshots) all.updates.push_back(*snapshot);
    const Status together = recorder->commit(all);
    if (together.code() != StatusCode::kInvalidArgument) return together;
    for (const SharedSnapshot& snapshot : snapshots) {
      ltm::Commit one;
      one.updates.push_back(*snapshot);
      const Status alone = recorder->commit(one);
      if (alone.code() == StatusCode::kInvalidArgument)
        refused.push_back({snapshot, alone});
      else
        ENGRAM_RETURN_IF_ERROR(alone);
    }
    return {};
  }

  /// Once more with the store as it is now, where a consolidation or a sealing changed it.
  template <typename Read>
  auto retried(const Read& read) -> decltype(read()) {
    auto first = read();
    if (first.ok() || first.status().code() != StatusCode::kUnavailable) return first;
    ENGRAM_RETURN_IF_ERROR(open_past());
    return read();
  }
};

LongTerm::LongTerm(std::unique_ptr<State> state) : state_(std::move(state)) {}
LongTerm::~LongTerm() = default;

Result<std::unique_ptr<LongTerm>> LongTerm::open(const Options& options, ltm::ModelLoader loader,
                                                 Clock clock) {
  auto state = std::make_unique<State>(options, std::move(loader));
  ENGRAM_ASSIGN_OR_RETURN(auto recorder,
                          ltm::Recorder::open(options.store, options.recording, std::move(clock)));
  state->recorder.emplace(std::move(recorder));
  state->counts.lost_frames = state->recorder->lost_frames();
  ENGRAM_RETURN_IF_ERROR(state->open_past());
  for (const MemoryId& entity : state->past->store().entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Timeline* timeline, state->past->store().timeline(entity));
    state->known[entity].until = timeline->last();
  }
  return std::unique_ptr<LongTerm>(new LongTerm(std::move(state)));
}

Status LongTerm::declare(const MemoryId& segment, const idf::Type& type) {
  const std::scoped_lock lock(state_->writing);
  if (state_->is_closed) return failed_precondition("store: is closed");
  return state_->recorder->declare(segment, type);
}

Status LongTerm::record(std::span<const SharedSnapshot> snapshots, std::vector<Refused>& refused) {
  const std::scoped_lock lock(state_->writing);
  if (state_->is_closed) return failed_precondition("store: is closed");
  // Of one entity and time the last one counts; a commit has each once.
  std::vector<std::vector<SharedSnapshot>> commits(1);
  std::map<MemoryId, size_t> next;
  for (const SharedSnapshot& snapshot : snapshots) {
    size_t& at = next[snapshot->id()];
    if (at == commits.size()) commits.emplace_back();
    commits[at++].push_back(snapshot);
  }
  {
    // Before it can be found, so that nobody takes an older state of the store for the newest.
    const std::unique_lock known(state_->known_mutex);
    ++state_->recordings;
    for (const SharedSnapshot& snapshot : snapshots) {
      Known& entity = state_->known[snapshot->entity];
      entity.until = std::max(entity.until.value_or(snapshot->time), snapshot->time);
    }
  }
  for (const auto& commit : commits) ENGRAM_RETURN_IF_ERROR(state_->record(commit, refused));
  {
    const std::unique_lock known(state_->known_mutex);
    ++state_->recordings;
    for (const SharedSnapshot& snapshot : snapshots)
      state_->known[snapshot->entity].recorded_at = state_->recordings;
  }
  const std::scoped_lock counting(state_->counting);
  if (state_->counts.decoded_bytes > 0)
    for (const auto& [id, count] : next) state_->replaced.push_back(id);
  state_->counts.recorded += snapshots.size() - refused.size();
  state_->counts.refused += refused.size();
  return {};
}

std::optional<Time> LongTerm::known_until(const MemoryId& entity) const {
  const std::shared_lock lock(state_->known_mutex);
  const auto found = state_->known.find(entity);
  return found == state_->known.end() ? std::nullopt : found->second.until;
}

std::vector<MemoryId> LongTerm::matching(const ltm::Query& query) const {
  std::vector<MemoryId> matching;
  const auto names = query.named_entities();
  const std::shared_lock lock(state_->known_mutex);
  if (names) {
    for (const MemoryId& name : *names)
      if (state_->known.contains(name)) matching.push_back(name);
    return matching;
  }
  for (const auto& [entity, known] : state_->known)
    if (query.matches(entity)) matching.push_back(entity);
  return matching;
}

Result<LongTerm::Answer> LongTerm::answer(const ltm::Query& query, const MemoryId& entity,
                                          std::span<const SharedSnapshot> held,
                                          size_t& most_bytes) {
  const std::scoped_lock lock(state_->reading);
  auto answer = state_->retried([&, before = most_bytes] {
    most_bytes = before;
    return state_->answer(query, entity, held, most_bytes);
  });
  if (answer.ok() && !query.is_ids_only())
    for (const ServedSnapshot& snapshot : answer->entity.snapshots)
      if (!snapshot.held) state_->accesses.note(entity, snapshot.answer.time);
  return answer;
}

Result<std::vector<ltm::SnapshotResult>> LongTerm::newest(const MemoryId& entity, Time until,
                                                          size_t most) {
  const auto read = [&]() -> Result<std::vector<ltm::SnapshotResult>> {
    std::vector<ltm::SnapshotResult> found;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * stored, state_->timeline(entity));
    for (Time time = until; stored != nullptr && found.size() < most;) {
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, stored->at_or_before(time));
      if (!entry) break;
      ENGRAM_ASSIGN_OR_RETURN(auto snapshot, state_->read(entity, *stored, entry->time));
      found.push_back(std::move(snapshot));
      time = entry->time - Duration(1);
    }
    std::ranges::reverse(found);
    return found;
  };
  const std::scoped_lock lock(state_->reading);
  return state_->retried(read);
}

Result<std::vector<ltm::Engine>> LongTerm::engines(const MemoryId& entity) {
  const std::scoped_lock lock(state_->reading);
  std::vector<ltm::Engine> engines;
  const ltm::Manifest& manifest = state_->past->store().manifest();
  const ltm::ModelInfo* newest = manifest.newest_model(entity);
  if (newest == nullptr || !state_->loader) return engines;
  ENGRAM_ASSIGN_OR_RETURN(const auto model, state_->model(state_->options.store / newest->file));
  if (model->predictor) engines.push_back({model->predictor.get(), newest->name()});
  if (model->copy_last) engines.push_back({model->copy_last.get(), ""});
  return engines;
}

LongTerm::ModelLock LongTerm::lock_models() {
  return ModelLock(state_->reading);
}

ltm::SegmentTypes LongTerm::types() {
  const std::scoped_lock lock(state_->reading);
  return state_->past->store().manifest().types;
}

LongTerm::Counters LongTerm::counters() const {
  const std::scoped_lock lock(state_->counting);
  return state_->counts;
}

Status LongTerm::close() {
  const std::scoped_lock lock(state_->writing);
  if (state_->is_closed) return {};
  state_->is_closed = true;
  return state_->recorder->close();
}

}  // namespace engram::server
