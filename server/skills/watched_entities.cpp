// SPDX-License-Identifier: Apache-2.0
#include "server/skills/watched_entities.h"

#include <algorithm>

#include "ltm/memory/answered_snapshots.h"

namespace engram::skills {

namespace {

/// The names of one subscription: it takes at most 256.
constexpr size_t kNamesOfOne = 250;
/// Requests must not be dropped while a disk is slow.
constexpr size_t kQueueBound = size_t{1} << 17;

}  // namespace

Status WatchedEntities::watch(const std::vector<std::string>& patterns) {
  bool is_new = false;
  for (const std::string& pattern : patterns) {
    ++counts_[pattern];
    is_new = is_new || !subscribed_.contains(pattern);
  }
  return is_new ? resubscribe() : Status();
}

void WatchedEntities::unwatch(const std::vector<std::string>& patterns) {
  for (const std::string& pattern : patterns)
    if (const auto found = counts_.find(pattern); found != counts_.end()) --found->second;
}

Status WatchedEntities::resubscribe() {
  const auto idle = std::ranges::count_if(counts_, [](const auto& one) { return one.second <= 0; });
  if (static_cast<size_t>(idle) > kMaxIdle)
    std::erase_if(counts_, [](const auto& one) { return one.second <= 0; });
  std::set<std::string> wanted;
  for (const auto& [pattern, count] : counts_) wanted.insert(pattern);
  SubscriptionHandlers handlers;
  handlers.on_snapshots = on_snapshots_;
  handlers.on_lost = [gap = on_gap_](uint64_t /*lost*/) { gap(); };
  handlers.on_interrupted = [gap = on_gap_](const Status& /*status*/) { gap(); };
  // The new ones begin before the old ones end, so that nothing is missed in between. What comes
  // twice is recognised by its time.
  std::vector<std::unique_ptr<Subscription>> begun;
  SubscriptionOptions options{.with_data = true, .queue_bound = kQueueBound};
  for (auto pattern = wanted.begin(); pattern != wanted.end();) {
    options.names.clear();
    for (; pattern != wanted.end() && options.names.size() < kNamesOfOne; ++pattern)
      options.names.push_back(*pattern);
    ENGRAM_ASSIGN_OR_RETURN(auto subscription, memory_.subscribe(options, handlers));
    begun.push_back(std::move(subscription));
  }
  subscriptions_ = std::move(begun);
  subscribed_ = std::move(wanted);
  return {};
}

Result<std::vector<ltm::Snapshot>> WatchedEntities::select(const std::string& pattern,
                                                           std::string_view selector) {
  auto answer = memory_.query(fmt::format("{} @ {}", pattern, selector));
  if (!answer.ok() && answer.status().code() != StatusCode::kNotFound) return answer.status();
  return answer.ok() ? ltm::answered_snapshots(*answer) : std::vector<ltm::Snapshot>();
}

Result<std::optional<ltm::Snapshot>> WatchedEntities::at(const ltm::MemoryId& entity, Time time) {
  const auto answer =
      memory_.query(ltm::Query::of_entity(entity, ltm::select::At{time}), std::string());
  if (!answer.ok() && answer.status().code() != StatusCode::kNotFound) return answer.status();
  std::vector<ltm::Snapshot> found;
  if (answer.ok()) found = ltm::answered_snapshots(*answer);
  return found.empty() ? std::nullopt : std::optional(std::move(found.front()));
}

}  // namespace engram::skills
