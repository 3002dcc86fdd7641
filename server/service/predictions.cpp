// SPDX-License-Identifier: Apache-2.0
#include "server/service/predictions.h"

#include <algorithm>

#include "server/prediction/entity_forecaster.h"

namespace engram::server {

using ltm::MemoryId;

namespace {

ltm::Snapshot to_snapshot(const MemoryId& entity, ltm::SnapshotResult read) {
  ltm::Snapshot snapshot{entity, read.time, {}};
  for (ltm::InstanceResult& instance : read.instances)
    snapshot.instances.push_back({std::move(instance.data), std::move(instance.metadata)});
  return snapshot;
}

}  // namespace

Result<std::vector<ltm::SnapshotResult>> Predictions::predict(const MemoryId& entity,
                                                              std::span<const Time> moments,
                                                              const std::string& engine,
                                                              Duration furthest) {
  const std::scoped_lock lock(mutex_);
  const auto models = store_ == nullptr ? LongTerm::ModelLock() : store_->lock_models();
  ENGRAM_ASSIGN_OR_RETURN(Learned * known, learned(entity));
  std::vector<Duration> horizons;
  for (const Time moment : moments) {
    const Duration ahead = moment - *known->last;
    if (ahead <= Duration(0) || ahead > furthest)
      return invalid_argument("'{}': found a prediction {} ahead, needs more than 0 and at most {}",
                              entity.to_string(), engram::to_string(ahead),
                              engram::to_string(furthest));
    horizons.push_back(ahead);
  }
  auto predicted = known->choice->predict(horizons, engine);
  if (!predicted.ok()) return predicted.status().with_context(entity.to_string());
  for (size_t i = 0; i < moments.size(); ++i) (*predicted)[i].time = moments[i];
  return predicted;
}

Result<std::vector<ltm::EngineRecord>> Predictions::records(const MemoryId& entity,
                                                            Duration ahead) {
  const std::scoped_lock lock(mutex_);
  const auto models = store_ == nullptr ? LongTerm::ModelLock() : store_->lock_models();
  ENGRAM_ASSIGN_OR_RETURN(Learned * known, learned(entity));
  return known->choice->records(ahead);
}

Result<Predictions::Learned*> Predictions::learned(const MemoryId& entity) {
  const auto found = std::ranges::find(learned_, entity, &Learned::entity);
  if (found != learned_.end()) {
    learned_.splice(learned_.begin(), learned_, found);
  } else {
    auto newest = memory_.all_of(entity, 1);
    std::optional<ltm::Snapshot> start;
    if (!newest.empty()) start = *newest.back();
    if (!start && store_ != nullptr) {
      ENGRAM_ASSIGN_OR_RETURN(auto stored, store_->newest(entity, Time::max(), 1));
      if (!stored.empty()) start = to_snapshot(entity, std::move(stored.back()));
    }
    if (!start) return not_found("'{}': there is no snapshot to predict from", entity.to_string());
    ENGRAM_ASSIGN_OR_RETURN(Learned begun, this->begun(entity, *start));
    learned_.push_front(std::move(begun));
    if (learned_.size() > kMostLearned) learned_.pop_back();
  }
  const Status added = add_new(learned_.front());
  if (added.ok() && learned_.front().last) return &learned_.front();
  learned_.pop_front();
  ENGRAM_RETURN_IF_ERROR(added);
  return not_found("'{}': there is no snapshot to predict from", entity.to_string());
}

Result<Predictions::Learned> Predictions::begun(const MemoryId& entity,
                                                const ltm::Snapshot& newest) {
  ltm::EngineChoiceInputs inputs{entity};
  inputs.type = memory_.type_of(entity);
  if (store_ != nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(inputs.models, store_->engines(entity));
  }
  inputs.condition_at = [this](const MemoryId& condition,
                               Time time) -> Result<std::optional<idf::Data>> {
    return condition_at(condition, time);
  };
  Learned learned{entity, make_entity_forecaster(std::move(inputs)), 1, std::nullopt};
  learned.wanted = std::max<size_t>(learned.choice->snapshots_wanted(newest), 1);
  return learned;
}

/// Adds what came since the last time. What came late is left out: engines go on from the newest.
Status Predictions::add_new(Learned& learned) {
  const auto held = memory_.all_of(learned.entity, learned.wanted);
  if (store_ != nullptr && held.size() < learned.wanted) {
    const Time until = held.empty() ? Time::max() : held.front()->time - Duration(1);
    if (!learned.last || *learned.last < until) {
      ENGRAM_ASSIGN_OR_RETURN(auto stored, store_->newest(learned.entity, until,
                                                          learned.wanted - held.size()));
      for (ltm::SnapshotResult& one : stored) {
        if (learned.last && one.time <= *learned.last) continue;
        learned.last = one.time;
        ENGRAM_RETURN_IF_ERROR(learned.choice->add(to_snapshot(learned.entity, std::move(one))));
      }
    }
  }
  for (const SharedSnapshot& one : held) {
    if (learned.last && one->time <= *learned.last) continue;
    learned.last = one->time;
    ENGRAM_RETURN_IF_ERROR(learned.choice->add(*one));
  }
  return {};
}

std::optional<idf::Data> Predictions::condition_at(const MemoryId& entity, Time time) const {
  const auto held = memory_.all_of(entity);
  const auto behind = std::ranges::upper_bound(held, time, {}, [](const SharedSnapshot& snapshot) {
    return snapshot->time;
  });
  if (behind != held.begin()) {
    const SharedSnapshot& known = *std::prev(behind);
    if (known->instances.empty()) return std::nullopt;
    return known->instances.front().data;
  }
  if (store_ == nullptr) return std::nullopt;
  auto stored = store_->newest(entity, time, 1);
  if (!stored.ok() || stored->empty() || stored->back().instances.empty()) return std::nullopt;
  return std::move(stored->back().instances.front().data);
}

}  // namespace engram::server
