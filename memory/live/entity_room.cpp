// SPDX-License-Identifier: Apache-2.0
#include "memory/live/entity_room.h"

#include <algorithm>

namespace engram::memory {

namespace {

constexpr std::chrono::seconds kBetweenCounts{1};

}  // namespace

Status EntityRoom::admit(const ltm::Commit& commit) {
  const MutexLock lock(mutex_);
  // Entities that are in both count twice here, so this may only say that there is room.
  if (memory_.entity_count() + recorded_.max_size() + commit.updates.size() <= max_entities_) {
    known_.reset();
    return {};
  }
  const ltm::MemoryId* first_new = nullptr;
  size_t more = 0;
  for (const ltm::EntityUpdate& update : commit.updates) {
    if (memory_.has(update.entity) || recorded_.contains(update.entity)) continue;
    if (first_new == nullptr) first_new = &update.entity;
    ++more;
  }
  if (more == 0) return {};
  const auto now = std::chrono::steady_clock::now();
  if (!known_ || (*known_ + more > max_entities_ && now - counted_at_ >= kBetweenCounts)) {
    known_ = count();
    counted_at_ = now;
    ++counts_;
  }
  if (*known_ + more > max_entities_)
    return resource_exhausted(
        "'{}' would be a new entity, and server '{}' has {} already, of at most {} (max_entities)",
        first_new->to_string(), name_, *known_, max_entities_);
  *known_ += more;
  return {};
}

size_t EntityRoom::count() const {
  const auto held = memory_.matching(ltm::Query());
  const auto both = std::ranges::count_if(
      held, [this](const ltm::MemoryId& entity) { return recorded_.contains(entity); });
  return held.size() + recorded_.size() - static_cast<size_t>(both);
}

uint64_t EntityRoom::counts() const {
  const MutexLock lock(mutex_);
  return counts_;
}

}  // namespace engram::memory
