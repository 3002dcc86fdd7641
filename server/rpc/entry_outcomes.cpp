// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/entry_outcomes.h"

#include <algorithm>
#include <iterator>

namespace engram::server {

namespace {

constexpr size_t kMaxRefusedEntries = 1024;
constexpr size_t kMaxMissedRanges = 64;

}  // namespace

void EntryOutcomes::refuse(uint64_t sequence, Status why) {
  refused_.insert_or_assign(sequence, std::move(why));
  if (refused_.size() <= kMaxRefusedEntries) return;
  unknown_below_ = std::max(unknown_below_, refused_.begin()->first + 1);
  refused_.erase(refused_.begin());
}

void EntryOutcomes::miss(uint64_t first, uint64_t end) {
  if (first >= end) return;
  auto at = missed_.upper_bound(first);
  if (at != missed_.begin() && std::prev(at)->second >= first)
    --at;
  else
    at = missed_.emplace_hint(at, first, end);
  at->second = std::max(at->second, end);
  // No two ranges touch.
  for (auto next = std::next(at); next != missed_.end() && next->first <= at->second;
       next = missed_.erase(next))
    at->second = std::max(at->second, next->second);
  if (missed_.size() <= kMaxMissedRanges) return;
  unknown_below_ = std::max(unknown_below_, missed_.begin()->second);
  missed_.erase(missed_.begin());
}

bool EntryOutcomes::is_missed(uint64_t sequence) const {
  if (refused_.contains(sequence)) return false;
  const auto after = missed_.upper_bound(sequence);
  return after != missed_.begin() && std::prev(after)->second > sequence;
}

Status EntryOutcomes::of(uint64_t sequence) const {
  if (const auto refused = refused_.find(sequence); refused != refused_.end())
    return refused->second;
  if (sequence < unknown_below_)
    return data_loss("{}: what became of entry {} is not known any more", ring_, sequence);
  if (is_missed(sequence))
    return data_loss("{}: entry {} was overwritten before it could pass", ring_, sequence);
  return {};
}

}  // namespace engram::server
