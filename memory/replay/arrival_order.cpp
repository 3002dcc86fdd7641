// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/arrival_order.h"

#include <algorithm>

#include "ltm/core/log.h"

namespace engram::memory {

using ltm::Arrival;

ArrivalOrder::ArrivalOrder(ltm::ReplayedPast& past)
    : past_(past), entities_(past.store().entities()) {}

void ArrivalOrder::restart(Time now) {
  from_ = now;
  prepared_ = 0;
  places_ = {};
}

Result<std::optional<Arrival>> ArrivalOrder::next_of(size_t entity, const Arrival& after) {
  ENGRAM_ASSIGN_OR_RETURN(const auto arrivals, past_.arrivals(entities_[entity]));
  if (!arrivals->is_in_time()) return arrivals->next(after);
  if (after.arrived == Time::max()) return std::optional<Arrival>();
  ENGRAM_ASSIGN_OR_RETURN(const auto past, past_.of(entities_[entity]));
  if (!past) return std::optional<Arrival>();
  ENGRAM_ASSIGN_OR_RETURN(const auto time, past->at_or_after(after.arrived + Duration(1)));
  return time ? std::optional(Arrival{*time, *time}) : std::nullopt;
}

Status ArrivalOrder::push_next(size_t entity, const Arrival& after) {
  const auto next = next_of(entity, after);
  if (next.status().code() == StatusCode::kUnavailable) return next.status();
  if (!next.ok())
    log::warning("replay: nobody is told of '{}' any more: {}", entities_[entity].to_string(),
                 next.status().message());
  if (next.ok() && *next) places_.emplace((*next)->arrived, entity, (*next)->time);
  return {};
}

Result<bool> ArrivalOrder::prepare(size_t max) {
  for (; max > 0 && prepared_ < entities_.size(); --max) {
    ENGRAM_RETURN_IF_ERROR(push_next(prepared_, {from_, Time::max()}));
    ++prepared_;
  }
  return prepared_ == entities_.size();
}

std::optional<Time> ArrivalOrder::next() const {
  ENGRAM_CHECK(prepared_ == entities_.size(), "{} of {} entities are prepared", prepared_,
               entities_.size());
  return places_.empty() ? std::nullopt : std::optional(std::get<0>(places_.top()));
}

Result<std::vector<ltm::MemoryId>> ArrivalOrder::take() {
  ENGRAM_CHECK(!places_.empty(), "there is nothing more");
  const Time arrived = std::get<0>(places_.top());
  std::vector<ltm::MemoryId> taken;
  while (!places_.empty() && std::get<0>(places_.top()) == arrived) {
    const auto [at, entity, time] = places_.top();
    places_.pop();
    taken.push_back(entities_[entity].at(time));
    ENGRAM_RETURN_IF_ERROR(push_next(entity, {at, time}));
  }
  // What one entity has of this arrival was pushed one by one, behind those of later IDs.
  std::ranges::sort(taken);
  return taken;
}

}  // namespace engram::memory
