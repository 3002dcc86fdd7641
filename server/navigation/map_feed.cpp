// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_feed.h"

#include "ltm/core/log.h"
#include "ltm/memory/answered_snapshots.h"

namespace engram::navigation {

Result<std::unique_ptr<MapFeed>> MapFeed::open(Memory& memory, const ltm::MemoryId& entity) {
  std::unique_ptr<MapFeed> feed(new MapFeed(memory, entity));
  SubscriptionHandlers handlers;
  handlers.on_snapshots = [raw = feed.get()](std::vector<ToldSnapshot> told) {
    // Only the last of them counts.
    ltm::Snapshot& last = told.back().snapshot;
    if (!told.back().has_data) {
      MutexLock lock(raw->mutex_);
      raw->must_ask_ = true;
      return;
    }
    if (last.instances.empty()) return;
    auto map = CostMap::from_data(last.instances.front().data, last.id().instance(0));
    if (map.ok())
      raw->take(*std::move(map));
    else
      log::warning("navigation: '{}': {}", last.id().printable(), map.status().message());
  };
  handlers.on_interrupted = [raw = feed.get()](const Status&) {
    MutexLock lock(raw->mutex_);
    raw->must_ask_ = true;
  };
  ENGRAM_ASSIGN_OR_RETURN(feed->subscription_,
                          memory.subscribe({.names = {ltm::exact_names(entity)}, .with_data = true},
                                           std::move(handlers)));
  ENGRAM_RETURN_IF_ERROR(feed->ask());
  return feed;
}

Status MapFeed::ask() {
  const auto found = memory_.query(ltm::Query::of_entity(entity_, ltm::select::Latest{}));
  if (!found.ok() && found.status().code() == StatusCode::kNotFound) return {};
  ENGRAM_RETURN_IF_ERROR(found.status());
  const ltm::EntityResult* entity = found->find_entity(entity_);
  if (entity == nullptr || entity->snapshots.empty()) return {};
  const ltm::SnapshotResult& last = entity->snapshots.back();
  if (last.instances.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(CostMap map, CostMap::from_data(last.instances.front().data,
                                                          entity_.at(last.time).instance(0)));
  take(std::move(map));
  return {};
}

void MapFeed::take(CostMap map) {
  MutexLock lock(mutex_);
  if (latest_ != nullptr && latest_->id.time() >= map.id.time()) return;
  latest_ = std::make_shared<const CostMap>(std::move(map));
  came_.notify_all();
}

std::shared_ptr<const CostMap> MapFeed::latest() {
  bool must_ask = false;
  {
    MutexLock lock(mutex_);
    std::swap(must_ask, must_ask_);
  }
  const Status asked = must_ask ? ask() : Status();
  MutexLock lock(mutex_);
  must_ask_ = must_ask_ || !asked.ok();
  return latest_;
}

bool MapFeed::wait_for(Time time, Duration timeout) const {
  MutexLock lock(mutex_);
  return came_.wait_for(mutex_, timeout, [&]() ENGRAM_REQUIRES(mutex_) {
    return latest_ != nullptr && latest_->id.time() >= time;
  });
}

}  // namespace engram::navigation
