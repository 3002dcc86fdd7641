// SPDX-License-Identifier: Apache-2.0
// How entries of a ring pass to working memory.
#include <algorithm>

#include "ltm/core/log.h"
#include "server/rpc/memory_rpc.h"
#include "server/rpc/ring_entry.h"
#include "server/rpc/shared_ring.h"
#include "server/sharing/ring_places.h"
#include "server/wire/wire_snapshot.h"

namespace engram::server {

void SharedRing::pass() {
  const MutexLock lock(passing_);
  pass_attended(false);
}

Status SharedRing::pass_until(uint64_t written) {
  const MutexLock lock(passing_);
  const bool was_there = reader_.has_value();
  pass_attended(true);
  const Status call = count_call();
  // What another call passed is there, whatever the rate says of this one.
  if (!call.ok() && (!reader_ || written > end_)) return call;
  if (!reader_)
    return failed_precondition("sensory ring {}: {}", id_,
                               was_there ? "was closed" : "has not begun, or is closed");
  const uint64_t sequence = written - 1;
  const Status outcome = outcomes_.of(sequence);
  if (!outcomes_.is_missed(sequence)) return outcome;
  // How many snapshots it had is not known. It is counted once.
  ++counts_.refused;
  context_.metrics.refused_commits.add();
  log::warning("{}", outcome.message());
  outcomes_.refuse(sequence, outcome);
  return outcome;
}

/// A client calls for each entry, and the first of its calls may pass many. So each entry that a
/// call passes counts, and then the call that it may be of does not.
Status SharedRing::count_call() {
  if (untold_ > 0) {
    --untold_;
    return {};
  }
  return context_.take_request(who_, "commit");
}

uint64_t SharedRing::not_passed(uint64_t entities, uint64_t sequence) const {
  uint64_t left = 0;
  for (const size_t place : RingPlaces(entities)) {
    if (passed_until_[place] <= sequence) left |= bit_of_place(place);
  }
  const auto early = passed_early_.find(sequence);
  return early == passed_early_.end() ? left : left & ~early->second;
}

std::optional<SensoryRingReader::Range> SharedRing::look() {
  const SensoryRingReader::Range range = reader_->entries();
  if (range.end < end_) {
    close(fmt::format("it had {} entries, and then {}", end_, range.end));
    return std::nullopt;
  }
  outcomes_.miss(end_, range.first);
  passed_early_.erase(passed_early_.begin(), passed_early_.lower_bound(range.first));
  return range;
}

void SharedRing::pass_attended(bool is_counted) {
  if (!reader_) return;
  uint64_t attended = 0;
  uint64_t openings = 0;
  OfPlaces oldest{};
  {
    const MutexLock lock(placing_);
    attended = control_->attended;
    openings = openings_;
    oldest = oldest_passed_;
  }
  if (attended == 0) return;
  // After the look at who attends: the client looks after it wrote, so one of both sees the other.
  std::atomic_thread_fence(std::memory_order_seq_cst);
  const auto range = look();
  if (!range) return;
  uint64_t first = range->end;
  for (const size_t place : RingPlaces(attended)) {
    first = std::min(first, passed_until_[place]);
  }
  // What lies in the ring beside each other: a client that has entries overlap asks for more.
  size_t budget = entries_->size();
  for (uint64_t sequence = std::max(first, range->first); sequence < range->end; ++sequence) {
    const auto entry = reader_->find(sequence);
    if (!entry) {
      if (sequence >= end_) outcomes_.miss(sequence, sequence + 1);
      continue;
    }
    uint64_t wanted = not_passed(entry->entities & attended, sequence);
    for (const size_t place : RingPlaces(wanted)) {
      if (entry->came_ns < oldest[place]) wanted &= ~bit_of_place(place);
    }
    if (wanted != 0)
      pass_entry(*entry, wanted, budget, is_counted, {});
    else if ((entry->entities & attended) != 0 &&
             not_passed(entry->entities, sequence) == entry->entities)
      // Too old. What nobody attends to may pass yet, when somebody does.
      outcomes_.miss(sequence, sequence + 1);
  }
  end_ = range->end;
  for (const size_t place : RingPlaces(attended)) {
    passed_until_[place] = range->end;
    control_->passed_until[place] = range->end;
  }
  const MutexLock lock(placing_);
  // Where attention opened to more meanwhile, its own call says what was taken.
  if (openings == openings_) control_->taken = range->end;
}

void SharedRing::pass_chosen(const memory::IsChosen& is_chosen) {
  const MutexLock lock(passing_);
  if (!reader_) return;
  const auto range = look();
  if (!range) return;
  const int64_t oldest = oldest_came();
  size_t budget = entries_->size();
  for (uint64_t sequence = range->first; sequence < range->end; ++sequence) {
    const auto entry = reader_->find(sequence);
    if (!entry || entry->came_ns < oldest) continue;
    const uint64_t left = not_passed(entry->entities, sequence);
    if (left == 0) continue;
    const uint64_t passed = pass_entry(*entry, left, budget, false, is_chosen);
    if (passed != 0) passed_early_[sequence] |= passed;
  }
}

uint64_t SharedRing::pass_entry(const SensoryEntry& entry, uint64_t wanted, size_t& budget,
                                bool is_counted, const memory::IsChosen& is_chosen) {
  auto message = read_head(entry, wanted, budget, is_chosen);
  if (message.ok() && message->updates_size() == 0) return 0;
  Status status = message.ok() ? take(entry, *message, budget, is_counted) : message.status();
  // Overwritten while it was copied: a client that keeps to the rules does so only to what nobody
  // attended to when it began. It is lost as any other.
  if (status.code() == StatusCode::kNotFound) {
    if (not_passed(entry.entities, entry.sequence) == entry.entities)
      outcomes_.miss(entry.sequence, entry.sequence + 1);
    return 0;
  }
  context_.metrics.commits.add();
  const auto snapshots =
      message.ok() ? static_cast<uint64_t>(message->updates_size()) : uint64_t{1};
  if (status.ok()) {
    counts_.passed += snapshots;
    return wanted;
  }
  log::debug("sensory ring of '{}': {}", segment_.match.to_string(), status.to_string());
  context_.metrics.refused_commits.add();
  counts_.refused += snapshots;
  outcomes_.refuse(entry.sequence, std::move(status));
  return wanted;
}

Result<v1::CommitRequest> SharedRing::read_head(const SensoryEntry& entry, uint64_t& wanted,
                                                size_t& budget, const memory::IsChosen& is_chosen) {
  ENGRAM_ASSIGN_OR_RETURN(v1::CommitRequest message, read_ring_head(*reader_, entry, budget));
  if (static_cast<size_t>(message.updates_size()) > kMaxRingEntities)
    return data_loss("found {} snapshots, needs at most {}", message.updates_size(),
                     kMaxRingEntities);
  struct Known {
    memory::SharedSensoryEntity entity;
    std::string name;
    uint64_t bit;
  };
  std::vector<Known> known;
  {
    const MutexLock lock(placing_);
    for (const size_t place : RingPlaces(wanted)) {
      if (place < entities_.size())
        known.push_back({entities_[place], entities_[place]->id.to_string(), bit_of_place(place)});
    }
  }
  v1::CommitRequest taken;
  int found = 0;
  uint64_t chosen = 0;
  for (v1::Snapshot& update : *message.mutable_updates())
    for (const auto& [entity, name, bit] : known) {
      if (update.entity() != name) continue;
      ++found;
      if (is_chosen && !is_chosen(entity->id, time_from_ns(update.time_ns()))) break;
      chosen |= bit;
      taken.mutable_updates()->Add(std::move(update));
      break;
    }
  if (found == 0 || static_cast<size_t>(found) > known.size())
    return data_loss("found {} snapshots of {} entities, needs one of each", found, known.size());
  wanted = chosen;
  return taken;
}

Status SharedRing::take(const SensoryEntry& entry, v1::CommitRequest& message, size_t& budget,
                        bool is_counted) {
  if (is_counted) {
    ++untold_;
    ENGRAM_RETURN_IF_ERROR(context_.take_request(who_, "commit"));
  }
  ENGRAM_ASSIGN_OR_RETURN(const Buffer data, copy_ring_data(context_, segment_.match.names()[0],
                                                            *reader_, entry, message, budget));
  ENGRAM_ASSIGN_OR_RETURN(WireCommit commit, take_commit(message, data));
  for (const ltm::EntityUpdate& update : commit.commit.updates)
    if (Status status = who_.check(Right::kWrite, update.entity, update.time); !status.ok())
      return context_.audited(who_.name(), "commit", update.entity.to_string(), std::move(status));
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Admission admission,
      context_.service.commit(std::move(commit.commit), std::move(commit.encoded)));
  publish(context_, admission.snapshots);
  return {};
}

}  // namespace engram::server
