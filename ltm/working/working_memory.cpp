// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/working_memory.h"

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <random>
#include <shared_mutex>
#include <unordered_map>
#include <utility>

#include "ltm/memory/links.h"
#include "ltm/memory/select.h"
#include "ltm/working/history_moments.h"
#include "ltm/working/kept_entity.h"

namespace engram::ltm {

namespace {

/// Entities that are compared for one that leaves.
constexpr size_t kCompared = 16;

/// A snapshot on its way in.
struct Arrival {
  SharedSnapshot snapshot;
  size_t bytes = 0;
  std::vector<MemoryId> links;  ///< Entities, each once.
  bool has_links = false;       ///< It says what it links to: its type knows.
};

/// A snapshot that the online phase is to take.
struct Waiting {
  SharedSnapshot snapshot;
  size_t bytes = 0;
};

/// The entities that a snapshot links to, by its type.
void note_links(Arrival& arrival, const idf::Type* type) {
  if (type == nullptr) return;
  arrival.has_links = true;
  for (const Instance& instance : arrival.snapshot->instances)
    for (const Link& link : find_links(instance.data, *type))
      if (link.id.has_entity()) arrival.links.push_back(link.id.entity());
  std::ranges::sort(arrival.links);
  const auto same = std::ranges::unique(arrival.links);
  arrival.links.erase(same.begin(), same.end());
}

/// Makes the values what their segment's type wants. Returns how many lost something by it.
Result<size_t> reinterpret(HeldSnapshot& held, const idf::Type* type, const SegmentTypes& types) {
  size_t lost = 0;
  if (type == nullptr) return lost;
  for (Instance& instance : held.instances) {
    ENGRAM_ASSIGN_OR_RETURN(auto value, types.reinterpret(held.entity, instance.data));
    if (value.is_cast) held.encoded.clear();
    if (!value.notes.empty()) ++lost;
    instance.data = std::move(value.value);
  }
  return lost;
}

}  // namespace

Status WorkingMemory::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(all.validate());
  for (const SegmentLimits& segment : segments) {
    if (segment.segment.depth() == 0 || segment.segment.time())
      return invalid_argument("limits: found '{}', needs a memory, a segment or an entity",
                              segment.segment.to_string());
    ENGRAM_RETURN_IF_ERROR(segment.limits.validate());
  }
  if (store_interval <= Duration(0))
    return invalid_argument("store_interval: found {}, needs more than zero",
                            to_string(store_interval));
  if (read_half_life <= Duration(0))
    return invalid_argument("read_half_life: found {}, needs more than zero",
                            to_string(read_half_life));
  return {};
}

struct WorkingMemory::State {
  State(const Options& given, Clock now)
      : options(given), clock(std::move(now)), random(given.seed) {
    parts.push_back({{}, options.all, 0, 0, {}});
    for (const SegmentLimits& segment : options.segments)
      parts.push_back({segment.segment, segment.limits, 0, 0, {}});
  }

  const Options options;
  const Clock clock;

  mutable std::shared_mutex mutex;
  SegmentTypes types;
  std::map<MemoryId, std::unique_ptr<KeptEntity>> entities;
  std::unordered_map<MemoryId, KeptEntity*> by_id;
  std::deque<LimitedPart> parts;  ///< The first: all.
  std::deque<Waiting> waiting;
  std::vector<SharedSnapshot> gone;  ///< To be freed without the lock, see take_gone().
  uint64_t queued = 0;               ///< That ever waited.
  MemoryCounters counts;
  mutable std::atomic<uint64_t> reads{0};
  std::minstd_rand random;

  std::mutex storing;  ///< Held while a sink runs; taken before `mutex`.

  [[nodiscard]] KeptEntity* find(const MemoryId& entity) const {
    const auto found = by_id.find(entity);
    return found == by_id.end() ? nullptr : found->second;
  }

  KeptEntity& entity_of(const MemoryId& id) {
    if (KeptEntity* known = find(id)) return *known;
    auto made = std::make_unique<KeptEntity>(id);
    for (LimitedPart& part : parts)
      if (part.id.is_prefix_of(id)) made->parts.push_back({&part, 0});
    KeptEntity& entity = *made;
    by_id.emplace(id, &entity);
    entities.emplace(id, std::move(made));
    return entity;
  }

  void forget_if_empty(KeptEntity& entity) {
    if (!entity.history.empty()) return;
    entity.unlink();
    const MemoryId id = entity.id;
    by_id.erase(id);
    entities.erase(id);
  }

  /// One snapshot more, or fewer, stays. Members of a part have one that does.
  void count_staying(KeptEntity& entity, size_t bytes, bool is_more) {
    for (KeptEntity::Membership& place : entity.parts) {
      place.part->snapshots += is_more ? 1 : size_t(-1);
      place.part->bytes += is_more ? bytes : 0 - bytes;
    }
    const bool is_member = entity.history.staying() > 0;
    if (is_member == entity.is_member) return;
    entity.is_member = is_member;
    for (KeptEntity::Membership& place : entity.parts) {
      auto& members = place.part->members;
      if (is_member) {
        place.index = members.size();
        members.push_back(&entity);
        continue;
      }
      KeptEntity* last = members.back();
      members[place.index] = last;
      for (KeptEntity::Membership& of_last : last->parts)
        if (of_last.part == place.part) of_last.index = place.index;
      members.pop_back();
    }
  }

  void queue(EntityHistory::Entry& entry) {
    if (entry.is_queued || entry.is_stored) return;
    entry.is_queued = true;
    ++queued;
    waiting.push_back({entry.snapshot, entry.bytes});
    counts.waiting_bytes += entry.bytes;
  }

  /// Whether what leaves has to be stored before.
  [[nodiscard]] bool must_store() const { return options.mode != StoreMode::kLatest; }

  /// The oldest one of `entity` that stays is not to stay.
  void choose_oldest(KeptEntity& entity) {
    EntityHistory::Entry& entry = entity.history.choose_oldest();
    count_staying(entity, entry.bytes, false);
    if (must_store()) queue(entry);
    if (entry.is_queued) return;  // Leaves when it is stored.
    ++(entry.is_stored ? counts.left : counts.dropped);
    gone.push_back(entry.snapshot);
    entity.history.erase(entity.history.leaving() - 1);
    --counts.snapshots;
    forget_if_empty(entity);
  }

  KeptEntity& most_gainful(const LimitedPart& part, Time now) {
    KeptEntity* best = nullptr;
    double most = -1;
    const size_t count = std::min(part.members.size(), kCompared);
    for (size_t i = 0; i < count; ++i) {
      const size_t index = part.members.size() <= kCompared ? i : random() % part.members.size();
      const double gain = leaving_gain(*part.members[index], now, options.read_half_life);
      if (gain > most) {
        most = gain;
        best = part.members[index];
      }
    }
    return *best;
  }

  std::vector<SharedSnapshot> take_gone() { return std::exchange(gone, {}); }

  void keep_limits(Time now) {
    for (LimitedPart& part : parts)
      while (part.is_exceeded() && !part.members.empty()) choose_oldest(most_gainful(part, now));
  }

  void put(Arrival arrival, Time now, bool to_store) {
    KeptEntity& entity = entity_of(arrival.snapshot->entity);
    EntityHistory::Entry entry(std::move(arrival.snapshot), now, arrival.bytes);
    auto placed = entity.history.put(std::move(entry));
    ++counts.committed;
    if (placed.replaced) {
      // Where it waits it is stored yet: it came first.
      ++counts.superseded;
      if (!placed.is_leaving) count_staying(entity, placed.replaced->bytes, false);
    } else {
      ++counts.snapshots;
    }
    EntityHistory::Entry& added = entity.history[placed.index];
    if (!placed.is_leaving) count_staying(entity, added.bytes, true);
    const bool is_due =
        options.mode == StoreMode::kLatest &&
        (entity.last_queued == Time::min() || now - entity.last_queued >= options.store_interval);
    if (is_due) entity.last_queued = now;
    if (to_store || options.mode == StoreMode::kEverything || is_due ||
        (placed.is_leaving && must_store()))
      queue(added);
    const bool is_newest = placed.index + 1 == entity.history.size();
    if (arrival.has_links && is_newest) link(entity, arrival.links);
  }

  void link(KeptEntity& entity, const std::vector<MemoryId>& links) {
    std::vector<KeptEntity*> targets;
    for (const MemoryId& id : links)
      if (KeptEntity* target = find(id); target != nullptr && target != &entity)
        targets.push_back(target);
    entity.link_to(std::move(targets));
  }

  /// Of what the sink took, what may go goes.
  void stored(const SharedSnapshot& snapshot) {
    ++counts.stored;
    KeptEntity* entity = find(snapshot->entity);
    const auto index = entity == nullptr ? std::nullopt : entity->history.find(snapshot->time);
    if (!index || entity->history[*index].snapshot != snapshot) return;  // Superseded.
    EntityHistory::Entry& entry = entity->history[*index];
    entry.is_queued = false;
    entry.is_stored = true;
    if (*index >= entity->history.leaving()) return;
    entity->history.erase(*index);
    ++counts.left;
    --counts.snapshots;
    forget_if_empty(*entity);
  }

  void select(const KeptEntity& entity, const Query& query, const KnownElsewhere& elsewhere,
              std::vector<SelectedEntity>& selected) const {
    HistoryMoments moments(entity.history, elsewhere ? elsewhere(entity.id) : std::nullopt);
    SelectedEntity one{entity.id, {}, {}, {}};
    // Moments in memory do not fail.
    auto asked = select_snapshots(query.snapshots_of(entity.id), moments);
    if (moments.reaches_elsewhere()) {
      one.reaches_elsewhere = true;
      selected.push_back(std::move(one));
      return;
    }
    for (SelectedSnapshot& snapshot : asked.value()) {
      if (snapshot.is_future) {
        one.future.push_back(snapshot.time);
        continue;
      }
      one.snapshots.push_back(entity.history[*entity.history.find(snapshot.time)].snapshot);
      one.instances.push_back(std::move(snapshot.instances));
    }
    if (!query.is_ids_only()) count_reads(entity, one.snapshots.size());
    selected.push_back(std::move(one));
  }

  void count_reads(const KeptEntity& entity, size_t count) const {
    entity.reads.fetch_add(static_cast<uint32_t>(count), std::memory_order_relaxed);
    reads.fetch_add(count, std::memory_order_relaxed);
  }
};

WorkingMemory::WorkingMemory(std::unique_ptr<State> state) : state_(std::move(state)) {}
WorkingMemory::~WorkingMemory() = default;

Result<std::unique_ptr<WorkingMemory>> WorkingMemory::create(const Options& options, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return std::unique_ptr<WorkingMemory>(
      new WorkingMemory(std::make_unique<State>(options, std::move(clock))));
}

Status WorkingMemory::declare(const MemoryId& segment, const idf::Type& type) {
  const std::unique_lock lock(state_->mutex);
  return state_->types.declare(segment, type);
}

Result<Admission> WorkingMemory::admit(Commit commit, std::vector<std::vector<Buffer>> encoded,
                                       bool to_store) {
  State& state = *state_;
  const auto refuse = [&state](Status status) {
    const std::unique_lock lock(state.mutex);
    ++state.counts.refused;
    return status;
  };
  if (Status status = commit.check(); !status.ok()) return refuse(std::move(status));
  ENGRAM_CHECK(encoded.empty() || encoded.size() == commit.updates.size(),
               "bytes of {} updates came with {}", encoded.size(), commit.updates.size());
  const Time now = state.clock();
  std::vector<Arrival> arrivals;
  arrivals.reserve(commit.updates.size());
  uint64_t reinterpreted = 0;
  const auto prepare = [&]() -> Status {
    const std::shared_lock lock(state.mutex);
    for (size_t i = 0; i < commit.updates.size(); ++i) {
      HeldSnapshot held{std::move(commit.updates[i]), {}};
      if (!encoded.empty()) held.encoded = std::move(encoded[i]);
      const idf::Type* type = state.types.of_entity(held.entity);
      ENGRAM_ASSIGN_OR_RETURN(const size_t cast, reinterpret(held, type, state.types));
      reinterpreted += cast;
      for (Instance& instance : held.instances) instance.metadata.arrived = now;
      const size_t bytes = held.plain_bytes() + kSnapshotOverhead;
      arrivals.push_back({std::make_shared<const HeldSnapshot>(std::move(held)), bytes, {}, false});
      note_links(arrivals.back(), type);
    }
    return {};
  };
  if (Status status = prepare(); !status.ok()) return refuse(std::move(status));
  Admission admission;
  admission.snapshots.reserve(arrivals.size());
  for (const Arrival& arrival : arrivals) admission.snapshots.push_back(arrival.snapshot);
  const std::unique_lock lock(state.mutex);
  if (state.counts.waiting_bytes > state.options.most_waiting_bytes) {
    ++state.counts.refused;
    return resource_exhausted(
        "working memory: {} bytes of {} snapshots wait for the online phase, needs at most {} to "
        "take more",
        state.counts.waiting_bytes, state.waiting.size(), state.options.most_waiting_bytes);
  }
  state.counts.reinterpreted += reinterpreted;
  for (Arrival& arrival : arrivals) state.put(std::move(arrival), now, to_store);
  state.keep_limits(now);
  admission.queued = state.queued;
  admission.gone = state.take_gone();
  return admission;
}

uint64_t WorkingMemory::taken() const {
  const std::shared_lock lock(state_->mutex);
  return state_->queued - state_->waiting.size();
}

SharedSnapshot WorkingMemory::find(const MemoryId& id) const {
  const std::shared_lock lock(state_->mutex);
  if (!id.has_entity()) return nullptr;
  const KeptEntity* entity = id.is_entity() ? state_->find(id) : state_->find(id.entity());
  if (entity == nullptr || entity->history.empty()) return nullptr;
  if (!id.time()) {
    state_->count_reads(*entity, 1);
    return entity->history.back().snapshot;
  }
  const auto index = entity->history.find(*id.time());
  if (!index) return nullptr;
  state_->count_reads(*entity, 1);
  return entity->history[*index].snapshot;
}

std::vector<SelectedEntity> WorkingMemory::select(const Query& query,
                                                  const KnownElsewhere& elsewhere) const {
  std::vector<SelectedEntity> selected;
  const auto names = query.named_entities();
  const std::shared_lock lock(state_->mutex);
  if (names) {
    for (const MemoryId& id : *names)
      if (const KeptEntity* entity = state_->find(id))
        state_->select(*entity, query, elsewhere, selected);
    return selected;
  }
  for (const auto& [id, entity] : state_->entities)
    if (query.matches(id)) state_->select(*entity, query, elsewhere, selected);
  return selected;
}

std::vector<MemoryId> WorkingMemory::matching(const Query& query) const {
  std::vector<MemoryId> matching;
  const auto names = query.named_entities();
  const std::shared_lock lock(state_->mutex);
  if (names) {
    for (const MemoryId& id : *names)
      if (state_->find(id) != nullptr) matching.push_back(id);
    return matching;
  }
  for (const auto& [id, entity] : state_->entities)
    if (query.matches(id)) matching.push_back(id);
  return matching;
}

std::vector<SharedSnapshot> WorkingMemory::all_of(const MemoryId& entity, size_t most) const {
  std::vector<SharedSnapshot> all;
  const std::shared_lock lock(state_->mutex);
  const KeptEntity* kept = state_->find(entity);
  if (kept == nullptr) return all;
  const size_t count = std::min(most, kept->history.size());
  all.reserve(count);
  for (size_t i = kept->history.size() - count; i < kept->history.size(); ++i)
    all.push_back(kept->history[i].snapshot);
  return all;
}

void WorkingMemory::count_reads(const MemoryId& entity, size_t count) const {
  const std::shared_lock lock(state_->mutex);
  if (const KeptEntity* kept = state_->find(entity)) state_->count_reads(*kept, count);
}

std::optional<idf::Type> WorkingMemory::type_of(const MemoryId& entity) const {
  const std::shared_lock lock(state_->mutex);
  const idf::Type* type = state_->types.of_entity(entity);
  return type == nullptr ? std::nullopt : std::optional(*type);
}

QueryResult WorkingMemory::query(const Query& query) const {
  QueryResult result(query.is_ids_only());
  for (const SelectedEntity& entity : select(query)) {
    EntityResult& answer = result.add_entity(entity.entity);
    for (size_t i = 0; i < entity.snapshots.size(); ++i) {
      const Snapshot& snapshot = *entity.snapshots[i];
      const auto& asked = entity.instances[i];
      SnapshotResult one;
      one.time = snapshot.time;
      if (snapshot.is_augmented()) one.source = Source::kAugmented;
      for (size_t k = 0; k < snapshot.instances.size(); ++k) {
        const auto index = static_cast<int32_t>(k);
        if (!asked.empty() && !std::ranges::binary_search(asked, index)) continue;
        const Instance& instance = snapshot.instances[k];
        one.instances.push_back(query.is_ids_only()
                                    ? InstanceResult{index, {}, {}}
                                    : InstanceResult{index, instance.data, instance.metadata});
      }
      if (!one.instances.empty()) answer.add(std::move(one));
    }
  }
  return result;
}

Result<size_t> WorkingMemory::store(const Sink& sink, size_t most_bytes) {
  State& state = *state_;
  const std::scoped_lock one_at_a_time(state.storing);
  std::vector<SharedSnapshot> taken;
  {
    const std::shared_lock lock(state.mutex);
    size_t bytes = 0;
    for (const Waiting& next : state.waiting) {
      bytes += next.bytes;
      if (bytes > most_bytes && !taken.empty()) break;
      taken.push_back(next.snapshot);
    }
  }
  if (taken.empty()) return size_t{0};
  ENGRAM_RETURN_IF_ERROR(sink(taken));
  const std::unique_lock lock(state.mutex);
  for (size_t i = 0; i < taken.size(); ++i) {
    state.counts.waiting_bytes -= state.waiting[i].bytes;
    state.stored(taken[i]);
  }
  state.waiting.erase(state.waiting.begin(),
                      state.waiting.begin() + static_cast<std::ptrdiff_t>(taken.size()));
  return taken.size();
}

void WorkingMemory::expire() {
  State& state = *state_;
  const Time now = state.clock();
  std::vector<SharedSnapshot> gone;
  const std::unique_lock lock(state.mutex);
  for (LimitedPart& part : state.parts) {
    if (!part.limits.age) continue;
    const auto is_old = [&](const KeptEntity& entity) {
      return entity.history.staying() > 0 &&
             now - entity.history[entity.history.leaving()].arrived > *part.limits.age;
    };
    // Members go as their last snapshot does: a copy.
    for (const std::vector<KeptEntity*> members = part.members; KeptEntity * entity : members) {
      const MemoryId id = entity->id;
      while (state.find(id) == entity && is_old(*entity)) state.choose_oldest(*entity);
    }
  }
  gone = state.take_gone();
}

void WorkingMemory::release_all() {
  std::vector<SharedSnapshot> gone;
  const std::unique_lock lock(state_->mutex);
  LimitedPart& all = state_->parts.front();
  while (!all.members.empty()) state_->choose_oldest(*all.members.back());
  gone = state_->take_gone();
}

Status WorkingMemory::set_limits(const MemoryLimits& all) {
  ENGRAM_RETURN_IF_ERROR(all.validate());
  const Time now = state_->clock();
  std::vector<SharedSnapshot> gone;
  const std::unique_lock lock(state_->mutex);
  state_->parts.front().limits = all;
  state_->keep_limits(now);
  gone = state_->take_gone();
  return {};
}

MemoryCounters WorkingMemory::counters() const {
  const std::shared_lock lock(state_->mutex);
  MemoryCounters counts = state_->counts;
  counts.entities = state_->entities.size();
  counts.bytes = state_->parts.front().bytes;
  counts.waiting = state_->waiting.size();
  counts.reads = state_->reads.load(std::memory_order_relaxed);
  return counts;
}

}  // namespace engram::ltm
