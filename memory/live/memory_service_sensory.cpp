// SPDX-License-Identifier: Apache-2.0
// What a memory service does with what precedes working memory.
#include "memory/live/memory_service_state.h"
#include "memory/live/subscription.h"

namespace engram::memory {

Status MemoryService::hold(ltm::Commit& commit, std::vector<std::vector<Buffer>>& encoded) {
  State& state = *state_;
  if (!state.sensory) return {};
  for (const ltm::EntityUpdate& update : commit.updates)
    ENGRAM_RETURN_IF_ERROR(owns(update.entity));
  return state.sensory->hold(commit, encoded);
}

Status MemoryService::pass(ltm::Commit commit, std::vector<std::vector<Buffer>> encoded) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Admission admission,
                          this->commit(std::move(commit), std::move(encoded)));
  if (state_->tell_passed) state_->tell_passed(admission.snapshots);
  return {};
}

Attention MemoryService::attend(SensoryMemory::Wanted is_wanted) {
  return state_->sensory ? state_->sensory->attend(std::move(is_wanted)) : Attention();
}

Result<Attention> MemoryService::attend(const std::string& names) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Query query, subscribed_names({names}));
  return attend(
      [query = std::move(query)](const ltm::MemoryId& entity) { return query.matches(entity); });
}

bool MemoryService::may_wait_for_sensory(const ltm::Query& query, const ltm::View* view) const {
  return state_->sensory && state_->sensory->selects(query, view);
}

const std::shared_ptr<SensoryMemory>& MemoryService::sensory() const {
  return state_->sensory;
}

void MemoryService::tell_of_passed(TellPassed tell) {
  state_->tell_passed = std::move(tell);
}

}  // namespace engram::memory
