// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_part.h"

#include <algorithm>
#include <map>

#include "ltm/core/log.h"
#include "ltm/recall/overlaid_past.h"
#include "memory/replay/replay_state.h"

namespace engram::memory {

namespace {

Time end_of_time() {
  return Time::max();
}

bool arrived_after(const ltm::HeldSnapshot& snapshot, Time now) {
  return std::ranges::any_of(snapshot.instances, [now](const ltm::Instance& instance) {
    return instance.metadata.arrived > now;
  });
}

}  // namespace

ReplayPart::ReplayPart(std::filesystem::path store, ltm::ModelLoader loader, Clock now,
                       std::unique_ptr<ltm::ReplayedPast> all)
    : store_(std::move(store)),
      loader_(std::move(loader)),
      now_(std::move(now)),
      types_(all->store().manifest().types),
      all_(std::move(all)),
      order_(*all_) {}

Result<std::unique_ptr<ReplayPart>> ReplayPart::open(const std::filesystem::path& store,
                                                     ltm::ModelLoader loader, Clock now) {
  ENGRAM_ASSIGN_OR_RETURN(auto all, ltm::ReplayedPast::open(store, loader, end_of_time));
  ENGRAM_ASSIGN_OR_RETURN(auto shown, ltm::ReplayedPast::open(store, loader, now, all.get()));
  auto part = std::unique_ptr<ReplayPart>(
      new ReplayPart(store, std::move(loader), std::move(now), std::move(all)));
  ltm::StoreReader& reader = part->all_->store();
  for (const ltm::MemoryId& entity : reader.entities()) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Timeline* times, reader.timeline(entity));
    if (!times->first()) continue;
    part->first_ = std::min(part->first_.value_or(*times->first()), *times->first());
    part->last_ = std::max(part->last_.value_or(*times->last()), *times->last());
  }
  const ExclusiveLock lock(part->mutex_);
  part->to_attach_ = std::move(shown);
  return part;
}

std::unique_ptr<ltm::KnownPast> ReplayPart::attach(const std::string& name,
                                                   ltm::WorkingMemory& above) {
  const ExclusiveLock lock(mutex_);
  ENGRAM_CHECK(to_attach_ != nullptr, "{}: is attached already", name);
  above_ = &above;
  return std::make_unique<ltm::OverlaidPast>(name, above, std::move(to_attach_));
}

void ReplayPart::detach() {
  const ExclusiveLock lock(mutex_);
  above_ = nullptr;
  listener_ = {};
}

void ReplayPart::tell(PastListener listener) {
  const ExclusiveLock lock(mutex_);
  listener_ = std::move(listener);
}

void ReplayPart::rewind(Time now) {
  predictions_.rewind(now);
  const SharedLock lock(mutex_);
  if (above_ == nullptr) return;
  std::map<ltm::MemoryId, TimeSet> later;
  for (const ltm::MemoryId& entity : above_->matching(*ltm::Query::parse(".*"))) {
    // The state of this moment came a moment after it.
    const bool is_state = entity == replay_clock_entity();
    for (const ltm::SharedSnapshot& snapshot : above_->all_of(entity))
      if (is_state ? snapshot->time > now_() : arrived_after(*snapshot, now))
        later[entity].insert(snapshot->time);
  }
  above_->forget(later);
}

void ReplayPart::take_back(std::span<const ltm::SharedSnapshot> snapshots) {
  std::map<ltm::MemoryId, TimeSet> all;
  for (const ltm::SharedSnapshot& snapshot : snapshots)
    all[snapshot->entity].insert(snapshot->time);
  const SharedLock lock(mutex_);
  if (above_ != nullptr) above_->forget(all);
}

void ReplayPart::take_back_later(std::span<const ltm::SharedSnapshot> snapshots) {
  const Time now = now_();
  std::map<ltm::MemoryId, TimeSet> later;
  for (const ltm::SharedSnapshot& snapshot : snapshots)
    if (arrived_after(*snapshot, now)) later[snapshot->entity].insert(snapshot->time);
  if (later.empty()) return;
  const SharedLock lock(mutex_);
  if (above_ != nullptr) above_->forget(later);
}

void ReplayPart::restart(Time now) {
  restarted_ = now;
  order_.restart(now);
}

Status ReplayPart::renew() {
  order_.restart(restarted_);
  return all_->renew().with_context("replay of '" + store_.string() + "'");
}

Result<bool> ReplayPart::prepare(size_t max) {
  const auto is_done = order_.prepare(max);
  if (is_done.ok()) return is_done;
  ENGRAM_RETURN_IF_ERROR(renew());
  return false;
}

Result<ltm::SnapshotResult> ReplayPart::read(const ltm::MemoryId& id) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, all_->of(id.entity()));
  if (past != nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(const auto found, past->at_or_after(*id.time()));
    if (found == id.time()) {
      ENGRAM_ASSIGN_OR_RETURN(ltm::RecalledSnapshot read,
                              past->read(*found, ltm::Prefer::kRecorded));
      return std::move(read.answer);
    }
  }
  return not_found("it was forgotten since the replay began");
}

std::vector<ltm::SharedSnapshot> ReplayPart::read_wanted(const std::vector<ltm::MemoryId>& ids,
                                                         uint64_t& unreadable) {
  std::vector<ltm::SharedSnapshot> told;
  bool is_renewed = false;
  for (const ltm::MemoryId& id : ids) {
    if (!listener_.is_wanted(id.entity())) continue;
    auto read = this->read(id);
    // The store was sealed or consolidated meanwhile; what it has is in the newest generation.
    if (read.status().code() == StatusCode::kUnavailable && !is_renewed) {
      is_renewed = true;
      if (const Status renewed = renew(); renewed.ok()) read = this->read(id);
    }
    if (read.ok()) {
      told.push_back(ltm::hold_untyped(to_snapshot(id.entity(), *std::move(read))));
      continue;
    }
    ++unreadable;
    log::warning("replay: nobody is told of '{}': {}", id.to_string(), read.status().message());
  }
  return told;
}

ReplayPart::Passed ReplayPart::pass() {
  const std::optional<Time> arrived = order_.next();
  ENGRAM_CHECK(arrived.has_value(), "'{}' has nothing more", store_.string());
  Passed passed;
  const auto ids = order_.take();
  if (!ids.ok()) {
    order_.restart(restarted_);  // It goes on once the store is renewed by prepare().
    return passed;
  }
  restarted_ = *arrived;
  passed.snapshots = ids->size();
  // Held until all are told, so that nobody is told after tell() or detach().
  const SharedLock lock(mutex_);
  if (!listener_.publish) return passed;
  const std::vector<ltm::SharedSnapshot> told = read_wanted(*ids, passed.unreadable);
  if (!told.empty()) listener_.publish(told);
  return passed;
}

Result<std::vector<PredictionScore>> ReplayPart::score(Time now) {
  if (!predictions_.has_waiting()) return std::vector<PredictionScore>();
  if (!come_) {
    ENGRAM_ASSIGN_OR_RETURN(come_, ltm::ReplayedPast::open(store_, loader_, now_, all_.get()));
  }
  ENGRAM_RETURN_IF_ERROR(come_->follow());
  return predictions_.compare(now, *come_);
}

void ReplayPart::commit(ltm::Commit commit) {
  const SharedLock lock(mutex_);
  if (above_ == nullptr) return;
  const auto admission = above_->admit(std::move(commit));
  if (!admission.ok())
    log::warning("replay: {}", admission.status().message());
  else if (listener_.publish)
    listener_.publish(admission->snapshots);
}

}  // namespace engram::memory
