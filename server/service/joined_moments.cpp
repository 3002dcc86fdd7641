// SPDX-License-Identifier: Apache-2.0
#include "server/service/joined_moments.h"

#include <algorithm>

namespace engram::server {

namespace {

std::optional<Time> earlier(std::optional<Time> a, std::optional<Time> b) {
  return a && b ? std::min(*a, *b) : (a ? a : b);
}

std::optional<Time> later(std::optional<Time> a, std::optional<Time> b) {
  return a && b ? std::max(*a, *b) : (a ? a : b);
}

Result<std::optional<Time>> time_of(const Result<std::optional<ltm::SnapshotEntry>>& entry) {
  if (!entry.ok()) return entry.status();
  return entry.value() ? std::optional((*entry)->time) : std::nullopt;
}

constexpr auto kTime = [](const SharedSnapshot& snapshot) { return snapshot->time; };

}  // namespace

std::optional<Time> JoinedMoments::first() const {
  const auto here = held_.empty() ? std::nullopt : std::optional(held_.front()->time);
  return stored_ == nullptr ? here : earlier(here, stored_->first());
}

std::optional<Time> JoinedMoments::last() const {
  const auto here = held_.empty() ? std::nullopt : std::optional(held_.back()->time);
  return stored_ == nullptr ? here : later(here, stored_->last());
}

Result<std::optional<Time>> JoinedMoments::at_or_after(Time time) {
  const auto found = std::ranges::lower_bound(held_, time, {}, kTime);
  const auto here = found == held_.end() ? std::nullopt : std::optional((*found)->time);
  if (stored_ == nullptr || here == time) return here;
  ENGRAM_ASSIGN_OR_RETURN(const auto there, time_of(stored_->at_or_after(time)));
  return earlier(here, there);
}

Result<std::optional<Time>> JoinedMoments::at_or_before(Time time) {
  const auto behind = std::ranges::upper_bound(held_, time, {}, kTime);
  const auto here =
      behind == held_.begin() ? std::nullopt : std::optional((*std::prev(behind))->time);
  if (stored_ == nullptr || here == time) return here;
  ENGRAM_ASSIGN_OR_RETURN(const auto there, time_of(stored_->at_or_before(time)));
  return later(here, there);
}

Result<std::optional<Time>> JoinedMoments::nth(uint64_t index) {
  if (stored_ == nullptr)
    return index < held_.size() ? std::optional(held_[index]->time) : std::nullopt;
  ENGRAM_RETURN_IF_ERROR(find_unstored());
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t stored, stored_->count());
  // How many of the unstored lie before the answer: the number for which both lists agree.
  const auto& unstored = *unstored_;
  size_t low = 0;
  size_t high = std::min<uint64_t>(unstored.size(), index);
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    // unstored[middle] lies before the answer if fewer than index - middle stored ones do.
    const uint64_t rank = index - middle - 1;
    ENGRAM_ASSIGN_OR_RETURN(const auto there, time_of(stored_->nth(rank)));
    if (rank >= stored || !there || unstored[middle] < *there)
      low = middle + 1;
    else
      high = middle;
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto there, time_of(stored_->nth(index - low)));
  const auto here = low < unstored.size() ? std::optional(unstored[low]) : std::nullopt;
  return earlier(here, there);
}

SharedSnapshot JoinedMoments::find(Time time) const {
  const auto found = std::ranges::lower_bound(held_, time, {}, kTime);
  return found != held_.end() && (*found)->time == time ? *found : nullptr;
}

Status JoinedMoments::find_unstored() {
  if (unstored_) return {};
  std::vector<Time> times;
  const auto last = stored_->last();
  for (const SharedSnapshot& snapshot : held_) {
    if (last && snapshot->time <= *last) {
      ENGRAM_ASSIGN_OR_RETURN(const auto there, time_of(stored_->at_or_after(snapshot->time)));
      if (there == snapshot->time) continue;
    }
    times.push_back(snapshot->time);
  }
  unstored_ = std::move(times);
  return {};
}

}  // namespace engram::server
