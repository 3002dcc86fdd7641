// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/entity_index.h"

#include <algorithm>
#include <optional>

namespace engram::ltm {

namespace {

/// In half microseconds: a search in a list, and a block that is unpacked first.
constexpr uint64_t kCostOfListed = 1;
constexpr uint64_t kCostOfPacked = 400;
/// A fifth of a second. All entities of 100,000 take as long.
constexpr uint64_t kMaxSpent = 400'000;

const EntityIndex::Entries kNone;

}  // namespace

EntityIndex::EntityIndex(const std::vector<SegmentInfo>& segments) {
  segments_.reserve(segments.size());
  for (const SegmentInfo& segment : segments) {
    segments_.push_back(segment.entities);
    cost_ += segment.entities.blocks() == nullptr ? kCostOfListed : kCostOfPacked;
  }
}

const EntityIndex::Entries& EntityIndex::of(const MemoryId& entity) {
  if (const auto found = known_.find(entity); found != known_.end()) return found->second;
  if (has_all_) return kNone;
  if (spent_ > kMaxSpent) {
    const auto found = all().find(entity);
    return found == known_.end() ? kNone : found->second;
  }
  spent_ += cost_;
  Entries entries;
  for (uint32_t i = 0; i < segments_.size(); ++i)
    if (const SegmentEntity* found = segments_[i].find(entity)) entries.emplace_back(i, found);
  // Names that are not there are not kept: anybody may ask for any.
  return entries.empty() ? kNone : known_.emplace(entity, std::move(entries)).first->second;
}

const std::map<MemoryId, EntityIndex::Entries>& EntityIndex::all() {
  if (has_all_) return known_;
  known_.clear();
  for (uint32_t i = 0; i < segments_.size(); ++i)
    for (const SegmentEntity& entity : segments_[i]) known_[entity.id].emplace_back(i, &entity);
  has_all_ = true;
  return known_;
}

size_t EntityIndex::max_size() const {
  if (has_all_) return known_.size();
  size_t size = 0;
  for (const SegmentEntities& entities : segments_) size += entities.size();
  return size;
}

std::optional<Time> last_time_in(const EntityIndex::Entries& entries) {
  std::optional<Time> last;
  for (const auto& [segment, entity] : entries)
    if (entity->snapshots > 0) last = std::max(last.value_or(entity->last), entity->last);
  return last;
}

}  // namespace engram::ltm
