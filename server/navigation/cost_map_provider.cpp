// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/cost_map_provider.h"

#include <algorithm>

#include "ltm/core/log.h"
#include "server/navigation/known_things.h"
#include "server/navigation/navigation_types.h"

namespace engram::navigation {

Result<std::unique_ptr<CostMapProvider>> CostMapProvider::start(Memory& memory,
                                                                const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(FloorThings things, FloorThings::create(options.rules));
  ENGRAM_ASSIGN_OR_RETURN(
      ObstacleMap map, ObstacleMap::create(options.rules.frame, options.rules.costs, options.base));
  std::unique_ptr<CostMapProvider> provider(
      new CostMapProvider(memory, options, std::move(things), std::move(map)));
  ENGRAM_RETURN_IF_ERROR(provider->begin());
  return provider;
}

CostMapProvider::CostMapProvider(Memory& memory, const Options& options, FloorThings things,
                                 ObstacleMap map)
    : memory_(memory),
      options_(options),
      entity_(options.rules.entity()),
      things_(std::move(things)),
      map_(std::move(map)) {}

CostMapProvider::~CostMapProvider() = default;

Status CostMapProvider::begin() {
  ENGRAM_RETURN_IF_ERROR(
      memory_.declare(entity_.parent().parent(), ::navigation::CostMap::idf_type()));
  // A provider that was there before has used times and versions.
  if (const auto before = memory_.query(ltm::Query::of_entity(entity_, ltm::select::Latest{}));
      before.ok()) {
    const ltm::EntityResult* found = before->find_entity(entity_);
    if (found != nullptr && !found->snapshots.empty()) {
      last_time_ = found->snapshots.back().time;
      const auto map = CostMap::from_data(found->snapshots.back().instances.front().data);
      if (map.ok()) version_ = map->version;
    }
  } else if (before.status().code() != StatusCode::kNotFound) {
    return before.status();
  }
  // Subscribed before asked: what comes in between comes twice, and nothing is missed.
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [this](std::vector<ToldSnapshot> told) {
    MutexLock lock(mutex_);
    for (ToldSnapshot& one : told) {
      if (one.has_data)
        waiting_.push_back(std::move(one.snapshot));
      else
        must_ask_ = true;
    }
    counters_.snapshots += told.size();
    has_work_.notify_one();
  };
  handlers.on_lost = [this](uint64_t lost) {
    MutexLock lock(mutex_);
    counters_.lost += lost;
    must_ask_ = true;
    has_work_.notify_one();
  };
  handlers.on_interrupted = [this](const Status& status) {
    log::warning("navigation: '{}' waits for the memory: {}", entity_.printable(),
                 status.message());
    MutexLock lock(mutex_);
    must_ask_ = true;
    has_work_.notify_one();
  };
  ENGRAM_ASSIGN_OR_RETURN(
      subscription_,
      memory_.subscribe({.names = things_.names(), .with_data = true}, std::move(handlers)));
  ENGRAM_RETURN_IF_ERROR(ask());
  ENGRAM_RETURN_IF_ERROR(bring_up_to_date());
  note_done();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  return {};
}

Status CostMapProvider::ask() {
  ENGRAM_RETURN_IF_ERROR(tell_things(memory_, things_));
  taken_ = things_.times();
  return {};
}

void CostMapProvider::run(const std::stop_token& stop) {
  bool must_retry = false;
  while (!stop.stop_requested()) {
    std::vector<ltm::Snapshot> snapshots;
    bool must_ask = false;
    {
      MutexLock lock(mutex_);
      const auto has_work = [this]()
                                ENGRAM_REQUIRES(mutex_) { return !waiting_.empty() || must_ask_; };
      if (must_retry)
        has_work_.wait_for(mutex_, stop, options_.retry,
                           [&]() ENGRAM_REQUIRES(mutex_) { return !waiting_.empty(); });
      else if (!has_work_.wait(mutex_, stop, has_work))
        return;
      snapshots.swap(waiting_);
      must_ask = must_ask_;
      must_ask_ = false;
    }
    Status status;
    if (must_ask) status = ask();
    const bool must_ask_again = !status.ok();
    for (const ltm::Snapshot& snapshot : snapshots)
      if (things_.take(snapshot)) {
        Time& taken = taken_[snapshot.entity];
        taken = std::max(taken, snapshot.time);
      }
    const Status made = bring_up_to_date();
    if (status.ok()) status = made;
    must_retry = !status.ok();
    if (made.ok()) note_done();
    if (must_retry) {
      log::warning("navigation: no new '{}': {}", entity_.printable(), status.message());
      MutexLock lock(mutex_);
      must_ask_ = must_ask_ || must_ask_again;
      ++counters_.failed_commits;
      counters_.last_failure = status.message();
    }
  }
}

Status CostMapProvider::bring_up_to_date() {
  is_outdated_ |= apply_changes(things_, options_.rules, map_);
  return is_outdated_ ? commit_map() : Status();
}

Status CostMapProvider::commit_map() {
  // Nothing tells the time yet. A map of the year 1970 would be the beginning of the memory.
  if (things_.newest() == Time{} && last_time_ == Time{}) {
    MutexLock lock(mutex_);
    latest_ = map_of_things(things_, map_);
    return {};
  }
  const Time time = std::max(things_.newest(), last_time_ + Duration(1));
  CostMap map = map_of_things(things_, map_);
  map.version = version_ + 1;
  map.id = entity_.at(time).instance(0);
  ltm::Instance instance{map.to_data(), {}};
  instance.metadata.created = time;
  instance.metadata.provider = options_.rules.provider;
  // A map that a crash loses is made again from the objects, so nobody waits for the disk.
  ENGRAM_RETURN_IF_ERROR(
      memory_.commit({{{entity_, time, {std::move(instance)}}}}, CommitDurability::kMemory));
  last_time_ = time;
  ++version_;
  is_outdated_ = false;
  MutexLock lock(mutex_);
  latest_ = std::move(map);
  ++counters_.maps;
  return {};
}

void CostMapProvider::note_done() {
  MutexLock lock(mutex_);
  for (const auto& [entity, time] : taken_) {
    Time& done = done_[entity];
    done = std::max(done, time);
  }
  taken_.clear();
  is_done_.notify_all();
}

CostMap CostMapProvider::latest() const {
  MutexLock lock(mutex_);
  return latest_;
}

bool CostMapProvider::wait_for(const ltm::MemoryId& snapshot, Duration timeout) const {
  MutexLock lock(mutex_);
  return is_done_.wait_for(mutex_, timeout, [&]() ENGRAM_REQUIRES(mutex_) {
    const auto found = done_.find(snapshot.entity());
    return found != done_.end() && found->second >= snapshot.time().value_or(Time{});
  });
}

CostMapProvider::Counters CostMapProvider::counters() const {
  MutexLock lock(mutex_);
  return counters_;
}

}  // namespace engram::navigation
