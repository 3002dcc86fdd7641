// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the state of a working memory, and what happens to it under its lock.

#include <algorithm>
#include <deque>
#include <map>
#include <random>
#include <unordered_map>

#include "ltm/core/mutex.h"
#include "ltm/working/history_moments.h"
#include "ltm/working/kept_entity.h"
#include "ltm/working/working_memory.h"

namespace engram::ltm {

/// The number of entities that are compared to choose one whose oldest snapshot leaves.
inline constexpr size_t kCompared = 16;

/// A snapshot that is being committed.
struct ArrivingSnapshot {
  SharedSnapshot snapshot;
  size_t bytes = 0;
  std::vector<MemoryId> links;  ///< The linked entities, each once.
  bool has_links = false;       ///< It has a type, which knows its links.
};

/// A snapshot that waits for the online phase.
struct WaitingSnapshot {
  SharedSnapshot snapshot;  ///< Null once it was forgotten: its number in the queue stays.
  size_t bytes = 0;
};

struct WorkingMemory::State {
  State(const Options& given, Clock now)
      : options(given), clock(std::move(now)), random(given.seed) {
    parts.push_back({{}, options.all, 0, 0, {}});
    for (const SegmentLimits& segment : options.segments)
      parts.push_back({segment.segment, segment.limits, 0, 0, {}});
  }

  const Options options;
  const Clock clock;

  Mutex storing ENGRAM_ACQUIRED_BEFORE(mutex);  ///< Held while a sink runs: one at a time.
  mutable SharedMutex mutex;
  SegmentTypes types ENGRAM_GUARDED_BY(mutex);
  std::map<MemoryId, std::unique_ptr<KeptEntity>> entities ENGRAM_GUARDED_BY(mutex);
  std::unordered_map<MemoryId, KeptEntity*> by_id ENGRAM_GUARDED_BY(mutex);
  std::deque<LimitedPart> parts ENGRAM_GUARDED_BY(mutex);  ///< The first one is the whole memory.
  std::deque<WaitingSnapshot> waiting ENGRAM_GUARDED_BY(mutex);
  /// Freed without the lock, see take_gone().
  std::vector<SharedSnapshot> gone ENGRAM_GUARDED_BY(mutex);
  uint64_t queued ENGRAM_GUARDED_BY(mutex) = 0;           ///< The number that ever waited.
  size_t forgotten_waiting ENGRAM_GUARDED_BY(mutex) = 0;  ///< Those in `waiting` that are null.
  MemoryCounters counts ENGRAM_GUARDED_BY(mutex);
  mutable std::atomic<uint64_t> reads{0};
  std::minstd_rand random ENGRAM_GUARDED_BY(mutex);

  [[nodiscard]] KeptEntity* find(const MemoryId& entity) const ENGRAM_REQUIRES_SHARED(mutex) {
    const auto found = by_id.find(entity);
    return found == by_id.end() ? nullptr : found->second;
  }

  /// The types that a commit is cast to.
  [[nodiscard]] SegmentTypes types_of(const Commit& commit) ENGRAM_EXCLUDES(mutex) {
    std::vector<MemoryId> updated;
    for (const Snapshot& update : commit.updates) updated.push_back(update.entity);
    const SharedLock lock(mutex);
    return types.of_entities(updated);
  }

  KeptEntity& entity_of(const MemoryId& id) ENGRAM_REQUIRES(mutex) {
    if (KeptEntity* known = find(id)) return *known;
    auto made = std::make_unique<KeptEntity>(id);
    for (LimitedPart& part : parts)
      if (part.id.is_prefix_of(id)) made->parts.push_back({&part, 0});
    KeptEntity& entity = *made;
    by_id.emplace(id, &entity);
    entities.emplace(id, std::move(made));
    return entity;
  }

  void forget_if_empty(KeptEntity& entity) ENGRAM_REQUIRES(mutex) {
    if (!entity.history.empty()) return;
    entity.unlink();
    const MemoryId id = entity.id;
    by_id.erase(id);
    entities.erase(id);
  }

  /// Counts one snapshot more, or less, that stays. An entity is a member of its parts as long as
  /// one of its snapshots stays.
  void count_staying(KeptEntity& entity, size_t bytes, bool is_more) ENGRAM_REQUIRES(mutex) {
    for (KeptEntity::Membership& place : entity.parts) {
      place.part->snapshots += is_more ? 1 : size_t(-1);
      place.part->bytes += is_more ? bytes : 0 - bytes;
    }
    const bool is_member = entity.history.staying() > 0;
    if (is_member == entity.is_member) return;
    entity.is_member = is_member;
    for (KeptEntity::Membership& place : entity.parts) {
      place.part->bytes += is_member ? kEntityOverhead : 0 - kEntityOverhead;
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

  void queue(EntityHistory::Entry& entry) ENGRAM_REQUIRES(mutex) {
    if (entry.is_queued || entry.is_stored) return;
    entry.is_queued = true;
    ++queued;
    waiting.push_back({entry.snapshot, entry.bytes});
    counts.waiting_bytes += entry.bytes;
  }

  /// Whether snapshots must be stored before they leave.
  [[nodiscard]] bool must_store() const { return options.mode != StoreMode::kLatest; }

  /// Chooses the oldest snapshot of `entity` that stays, to leave.
  void choose_oldest(KeptEntity& entity) ENGRAM_REQUIRES(mutex) {
    EntityHistory::Entry& entry = entity.history.choose_oldest();
    count_staying(entity, entry.bytes, false);
    if (must_store()) queue(entry);
    if (entry.is_queued) return;  // Leaves once it is stored.
    ++(entry.is_stored ? counts.left : counts.dropped);
    gone.push_back(entry.snapshot);
    entity.history.erase(entity.history.leaving() - 1);
    --counts.snapshots;
    forget_if_empty(entity);
  }

  KeptEntity& most_gainful(const LimitedPart& part, Time now) ENGRAM_REQUIRES(mutex) {
    KeptEntity* best = nullptr;
    double max = -1;
    // Samples instead of keeping an order: the gain changes with time and with each read, and
    // drawing 16 costs the same for any number of entities.
    const size_t count = std::min(part.members.size(), kCompared);
    for (size_t i = 0; i < count; ++i) {
      const size_t index = part.members.size() <= kCompared ? i : random() % part.members.size();
      const double gain = leaving_gain(*part.members[index], now, options.read_half_life);
      if (gain > max) {
        max = gain;
        best = part.members[index];
      }
    }
    return *best;
  }

  std::vector<SharedSnapshot> take_gone() ENGRAM_REQUIRES(mutex) { return std::exchange(gone, {}); }

  void keep_limits(Time now) ENGRAM_REQUIRES(mutex) {
    for (LimitedPart& part : parts)
      while (part.is_exceeded() && !part.members.empty()) choose_oldest(most_gainful(part, now));
  }

  void put(ArrivingSnapshot arrival, Time now, bool to_store) ENGRAM_REQUIRES(mutex) {
    KeptEntity& entity = entity_of(arrival.snapshot->entity);
    EntityHistory::Entry entry(std::move(arrival.snapshot), now, arrival.bytes);
    auto placed = entity.history.put(std::move(entry));
    ++counts.committed;
    if (placed.replaced) {
      // If the replaced one waits it is still stored, because it came first.
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

  void link(KeptEntity& entity, const std::vector<MemoryId>& links) ENGRAM_REQUIRES(mutex) {
    std::vector<KeptEntity*> targets;
    for (const MemoryId& id : links)
      if (KeptEntity* target = find(id); target != nullptr && target != &entity)
        targets.push_back(target);
    entity.link_to(std::move(targets));
  }

  /// Marks a snapshot that the sink took as stored; it leaves if it was chosen.
  void stored(const SharedSnapshot& snapshot) ENGRAM_REQUIRES(mutex) {
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

  /// Takes what waits of these times out of the queue. Its place stays, because the waiters of
  /// others count by it.
  std::vector<SharedSnapshot> forget_waiting(const std::map<MemoryId, TimeSet>& forgotten_times)
      ENGRAM_REQUIRES(mutex) {
    std::vector<SharedSnapshot> taken;
    for (WaitingSnapshot& next : waiting) {
      if (!next.snapshot) continue;
      const auto times = forgotten_times.find(next.snapshot->entity);
      if (times == forgotten_times.end() || !times->second.contains(next.snapshot->time)) continue;
      counts.waiting_bytes -= std::exchange(next.bytes, 0);
      taken.push_back(std::move(next.snapshot));
      next.snapshot = nullptr;
      ++forgotten_waiting;
    }
    return taken;
  }

  /// Removes what is here of one entity at these times. Returns how many snapshots that were.
  size_t forget(const MemoryId& id, const TimeSet& times, std::vector<SharedSnapshot>& freed)
      ENGRAM_REQUIRES(mutex) {
    KeptEntity* entity = find(id);
    if (entity == nullptr) return 0;
    std::vector<EntityHistory::Taken> taken = entity->history.take(times);
    for (EntityHistory::Taken& one : taken) {
      if (!one.was_leaving) count_staying(*entity, one.entry.bytes, false);
      freed.push_back(std::move(one.entry.snapshot));
    }
    counts.snapshots -= taken.size();
    counts.forgotten += taken.size();
    forget_if_empty(*entity);
    return taken.size();
  }

  void select(const KeptEntity& entity, const Query& query, const KnownElsewhere& elsewhere,
              std::vector<SelectedEntity>& selected) const ENGRAM_REQUIRES_SHARED(mutex) {
    HistoryMoments moments(entity.history, elsewhere ? elsewhere(entity.id) : std::nullopt);
    SelectedEntity one{entity.id, {}, {}, {}};
    const std::vector<SnapshotQuery> queries = query.snapshots_of(entity.id);
    if (!refuse_conditions(queries, "working memory").ok()) {
      // Places and links are looked up with the past below it.
      one.reaches_elsewhere = true;
      selected.push_back(std::move(one));
      return;
    }
    // Searches in memory cannot fail.
    auto asked = select_snapshots(queries, moments);
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
    selected.push_back(std::move(one));
  }

  void count_reads(const KeptEntity& entity, size_t count) const ENGRAM_REQUIRES_SHARED(mutex) {
    entity.reads.fetch_add(static_cast<uint32_t>(count), std::memory_order_relaxed);
    reads.fetch_add(count, std::memory_order_relaxed);
  }
};

}  // namespace engram::ltm
