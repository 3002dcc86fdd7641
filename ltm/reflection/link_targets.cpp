// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/link_targets.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Max number of texts that are kept; it bounds memory.
constexpr size_t kMaxLinkTexts = size_t{1} << 18;

std::vector<std::string> core_segment_of(const MemoryId& id) {
  const std::vector<std::string>& names = id.names();
  return {names.begin(), names.begin() + 2};
}

}  // namespace

LinkTargets::LinkTargets(StoreReader& store) : store_(store) {
  for (const MemoryId& entity : store.entities()) segments_.insert(core_segment_of(entity));
}

const MemoryId& LinkTargets::entity(int32_t number) const {
  ENGRAM_CHECK(number >= 0 && static_cast<size_t>(number) < known_.size(), "number {}", number);
  return known_[static_cast<size_t>(number)].entity;
}

Result<int32_t> LinkTargets::number_of(const MemoryId& entity) {
  const auto found = numbers_.find(entity);
  if (found != numbers_.end()) return found->second;
  const auto number = static_cast<int32_t>(known_.size());
  Known added{entity, {}, true};
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store_.timeline(entity));
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&added](const SnapshotEntry& entry) {
    added.times.push_back(to_ns(entry.time));
    return Status();
  }));
  known_.push_back(std::move(added));
  numbers_.emplace(entity, number);
  return number;
}

Result<const std::vector<int64_t>*> LinkTargets::times(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const int32_t number, number_of(entity));
  return &known_[static_cast<size_t>(number)].times;
}

Result<LinkTarget> LinkTargets::find(std::string_view text) {
  if (const auto known = texts_.find(text); known != texts_.end()) return known->second;
  ENGRAM_ASSIGN_OR_RETURN(const LinkTarget target, look_up(text));
  if (texts_.size() >= kMaxLinkTexts) texts_.clear();
  texts_.emplace(text, target);
  return target;
}

Result<LinkTarget> LinkTargets::look_up(std::string_view text) {
  LinkTarget target;
  const auto id = MemoryId::parse(text);
  if (!id.ok() || !id->has_entity()) return target;
  if (id->time()) {
    target.has_time = true;
    target.time_ns = to_ns(*id->time());
  }
  const MemoryId entity = id->entity();
  if (!store_.has(entity)) {
    target.state = segments_.contains(core_segment_of(entity)) ? LinkTarget::State::kNoEntity
                                                               : LinkTarget::State::kForeign;
    return target;
  }
  ENGRAM_ASSIGN_OR_RETURN(target.entity, number_of(entity));
  const std::vector<int64_t>& times = known_[static_cast<size_t>(target.entity)].times;
  if (!target.has_time || std::ranges::binary_search(times, target.time_ns)) {
    target.state = LinkTarget::State::kFound;
    return target;
  }
  const auto& forgotten = store_.manifest().forgotten;
  const auto gone = forgotten.find(entity);
  target.state = gone != forgotten.end() && gone->second.snapshots > 0
                     ? LinkTarget::State::kForgotten
                     : LinkTarget::State::kNoSnapshot;
  return target;
}

}  // namespace engram::ltm
