// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/access_table.h"

#include <algorithm>

namespace engram::ltm {

namespace {

constexpr uint64_t kMaxReads = INT64_MAX;

}  // namespace

void AccessTable::add(const MemoryId& entity, Time snapshot, uint64_t count, Time last) {
  if (count == 0) return;
  AccessStats& stats = entities_[entity][snapshot];
  stats.last = stats.count == 0 ? last : std::max(stats.last, last);
  // Files hold counts as int64, so a hostile count must not wrap.
  stats.count += std::min(count, kMaxReads - stats.count);
}

void AccessTable::add(const AccessTable& other) {
  for (const auto& [entity, snapshots] : other.entities_)
    for (const auto& [time, stats] : snapshots) add(entity, time, stats.count, stats.last);
}

AccessStats AccessTable::find(const MemoryId& entity, Time snapshot) const {
  const auto snapshots = entities_.find(entity);
  if (snapshots == entities_.end()) return {};
  const auto stats = snapshots->second.find(snapshot);
  return stats == snapshots->second.end() ? AccessStats{} : stats->second;
}

void AccessTable::erase(const MemoryId& entity, Time snapshot) {
  const auto snapshots = entities_.find(entity);
  if (snapshots == entities_.end()) return;
  snapshots->second.erase(snapshot);
  if (snapshots->second.empty()) entities_.erase(snapshots);
}

size_t AccessTable::size() const {
  size_t count = 0;
  for (const auto& [entity, snapshots] : entities_) count += snapshots.size();
  return count;
}

}  // namespace engram::ltm
