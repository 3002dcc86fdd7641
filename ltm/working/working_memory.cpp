// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/working_memory.h"

#include <utility>

#include "ltm/core/mutex.h"
#include "ltm/memory/links.h"
#include "ltm/working/working_memory_state.h"

namespace engram::ltm {

namespace {

/// Notes the entities that a snapshot links to, by its type.
void note_links(ArrivingSnapshot& arrival, const idf::Type* type) {
  if (type == nullptr) return;
  arrival.has_links = true;
  for (const Instance& instance : arrival.snapshot->instances)
    for (const Link& link : find_links(instance.data, *type))
      if (link.id.has_entity()) arrival.links.push_back(link.id.entity());
  std::ranges::sort(arrival.links);
  arrival.links.erase(std::unique(arrival.links.begin(), arrival.links.end()), arrival.links.end());
}

/// Casts all values ahead of a change. Bytes that hold values before their cast are dropped.
/// Returns how many instances lost something.
Result<uint64_t> cast_all(Commit& commit, std::vector<std::vector<Buffer>>& encoded,
                          const SegmentTypes& types) {
  uint64_t reinterpreted = 0;
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(const SnapshotCast cast, cast_to_type(commit.updates[i], types));
    if (cast.is_cast && !encoded.empty()) encoded[i].clear();
    reinterpreted += cast.notes.size();
  }
  return reinterpreted;
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
  ENGRAM_RETURN_IF_ERROR(ahead.validate());
  if (store_interval <= Duration(0))
    return invalid_argument("store_interval: found {}, needs more than zero",
                            to_string(store_interval));
  if (read_half_life <= Duration(0))
    return invalid_argument("read_half_life: found {}, needs more than zero",
                            to_string(read_half_life));
  return {};
}

WorkingMemory::WorkingMemory(std::unique_ptr<State> state) : state_(std::move(state)) {}
WorkingMemory::~WorkingMemory() = default;

Result<std::unique_ptr<WorkingMemory>> WorkingMemory::create(const Options& options, Clock clock) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return std::unique_ptr<WorkingMemory>(
      new WorkingMemory(std::make_unique<State>(options, std::move(clock))));
}

Status WorkingMemory::declare(const MemoryId& segment, const idf::Type& type) {
  const ExclusiveLock lock(state_->mutex);
  return state_->types.declare(segment, type);
}

Result<Admission> WorkingMemory::admit(Commit commit, std::vector<std::vector<Buffer>> encoded,
                                       bool to_store, const Change& change) {
  State& state = *state_;
  const auto refuse = [&state](Status status) {
    const ExclusiveLock lock(state.mutex);
    ++state.counts.refused;
    return status;
  };
  if (Status status = commit.check(); !status.ok()) return refuse(std::move(status));
  ENGRAM_CHECK(encoded.empty() || encoded.size() == commit.updates.size(),
               "bytes of {} updates came with {}", encoded.size(), commit.updates.size());
  const Time now = state.clock();
  const AheadLimits& ahead = state.options.ahead;
  for (const Snapshot& update : commit.updates)
    if (Status status = check_ahead(update.entity, update.time, now, ahead.of(update.entity));
        !status.ok())
      return refuse(std::move(status));
  uint64_t reinterpreted = 0;
  std::optional<SegmentTypes> types_at_change;
  if (change) {
    types_at_change = state.types_of(commit);
    const auto cast = cast_all(commit, encoded, *types_at_change);
    if (!cast.ok()) return refuse(cast.status());
    reinterpreted = *cast;
    change(commit, encoded);
    if (commit.updates.empty()) return Admission{{}, taken(), {}};
  }
  std::vector<ArrivingSnapshot> arrivals;
  arrivals.reserve(commit.updates.size());
  // Checking and casting are the long part: they hold the lock shared, so that queries go on.
  const auto prepare = [&]() -> Status {
    const SharedLock lock(state.mutex);
    const SegmentTypes& types = types_at_change ? *types_at_change : state.types;
    for (size_t i = 0; i < commit.updates.size(); ++i) {
      Snapshot& update = commit.updates[i];
      for (Instance& instance : update.instances) instance.metadata.arrived = now;
      std::vector<Buffer> came = encoded.empty() ? std::vector<Buffer>() : std::move(encoded[i]);
      ENGRAM_ASSIGN_OR_RETURN(auto checked, CheckedSnapshot::check<HeldSnapshot>(
                                                std::move(update), types, std::move(came)));
      reinterpreted += checked.cast.notes.size();
      const size_t bytes = checked.snapshot->ram_bytes();
      arrivals.push_back({std::move(checked.snapshot), bytes, {}, false});
      note_links(arrivals.back(), types.of_entity(arrivals.back().snapshot->entity));
    }
    return {};
  };
  if (Status status = prepare(); !status.ok()) return refuse(std::move(status));
  Admission admission;
  admission.snapshots.reserve(arrivals.size());
  for (const ArrivingSnapshot& arrival : arrivals) admission.snapshots.push_back(arrival.snapshot);
  const ExclusiveLock lock(state.mutex);
  if (state.counts.waiting_bytes > state.options.max_waiting_bytes) {
    ++state.counts.refused;
    return resource_exhausted(
        "working memory: {} bytes of {} snapshots wait for the online phase, needs at most {} to "
        "take more",
        state.counts.waiting_bytes, state.waiting.size() - state.forgotten_waiting,
        state.options.max_waiting_bytes);
  }
  state.counts.reinterpreted += reinterpreted;
  for (ArrivingSnapshot& arrival : arrivals) state.put(std::move(arrival), now, to_store);
  state.keep_limits(now);
  admission.queued = state.queued;
  admission.gone = state.take_gone();
  return admission;
}

Result<size_t> WorkingMemory::store(const Sink& sink, size_t max_bytes) {
  State& state = *state_;
  const MutexLock one_at_a_time(state.storing);
  std::vector<SharedSnapshot> taken;
  size_t count = 0;  // In the queue, with those that were forgotten.
  {
    const SharedLock lock(state.mutex);
    size_t bytes = 0;
    for (const WaitingSnapshot& next : state.waiting) {
      bytes += next.bytes;
      if (bytes > max_bytes && !taken.empty()) break;
      ++count;
      if (next.snapshot) taken.push_back(next.snapshot);
    }
  }
  if (count == 0) return size_t{0};
  // `mutex` is free while the sink writes to the disk, so commits and queries go on. Commits append
  // to `waiting`, and `storing` keeps others from shortening it: the taken ones are still its
  // first.
  if (!taken.empty()) ENGRAM_RETURN_IF_ERROR(sink(taken));
  const ExclusiveLock lock(state.mutex);
  const auto end = state.waiting.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto next = state.waiting.begin(); next != end; ++next) {
    state.counts.waiting_bytes -= next->bytes;
    if (!next->snapshot) --state.forgotten_waiting;
  }
  for (const SharedSnapshot& snapshot : taken) state.stored(snapshot);
  state.waiting.erase(state.waiting.begin(), end);
  return taken.size();
}

size_t WorkingMemory::forget(const std::map<MemoryId, TimeSet>& gone,
                             const std::function<void(std::span<const SharedSnapshot>)>& unstored) {
  State& state = *state_;
  // Declared before the locks, so that snapshots are freed after unlocking.
  std::vector<SharedSnapshot> freed;
  std::vector<SharedSnapshot> waited;
  size_t count = 0;
  // No sink has any of them now, and none gets them later.
  const MutexLock one_at_a_time(state.storing);
  {
    const ExclusiveLock lock(state.mutex);
    waited = state.forget_waiting(gone);
    for (const auto& [entity, times] : gone) count += state.forget(entity, times, freed);
  }
  if (unstored && !waited.empty()) unstored(waited);
  return count;
}

void WorkingMemory::expire() {
  State& state = *state_;
  const Time now = state.clock();
  // Declared before the lock, so that snapshots are freed after unlocking.
  std::vector<SharedSnapshot> gone;
  const ExclusiveLock lock(state.mutex);
  for (LimitedPart& part : state.parts) {
    if (!part.limits.age) continue;
    const auto is_old = [&](const KeptEntity& entity) {
      return entity.history.staying() > 0 &&
             now - entity.history[entity.history.leaving()].arrived > *part.limits.age;
    };
    // Copies the members: an entity is removed with its last snapshot.
    for (const std::vector<KeptEntity*> members = part.members; KeptEntity * entity : members) {
      const MemoryId id = entity->id;
      while (state.find(id) == entity && is_old(*entity)) state.choose_oldest(*entity);
    }
  }
  gone = state.take_gone();
}

void WorkingMemory::release_all() {
  std::vector<SharedSnapshot> gone;
  const ExclusiveLock lock(state_->mutex);
  LimitedPart& all = state_->parts.front();
  while (!all.members.empty()) state_->choose_oldest(*all.members.back());
  gone = state_->take_gone();
}

Status WorkingMemory::set_limits(const MemoryLimits& all) {
  ENGRAM_RETURN_IF_ERROR(all.validate());
  const Time now = state_->clock();
  std::vector<SharedSnapshot> gone;
  const ExclusiveLock lock(state_->mutex);
  state_->parts.front().limits = all;
  state_->keep_limits(now);
  gone = state_->take_gone();
  return {};
}

MemoryCounters WorkingMemory::counters() const {
  const SharedLock lock(state_->mutex);
  MemoryCounters counts = state_->counts;
  counts.entities = state_->entities.size();
  counts.bytes = state_->parts.front().bytes;
  counts.waiting = state_->waiting.size() - state_->forgotten_waiting;
  counts.reads = state_->reads.load(std::memory_order_relaxed);
  return counts;
}

}  // namespace engram::ltm
