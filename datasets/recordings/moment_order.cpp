// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/moment_order.h"

#include <algorithm>

#include "ltm/core/utf8.h"

namespace engram::datasets {

Time TimeShift::shifted(int64_t ns) {
  if (!shift_ns_) {
    shift_ns_ = 0;
    if (start_) shift_ns_ = to_ns(*start_) - ns;
  }
  int64_t moved = 0;
  if (__builtin_add_overflow(ns, *shift_ns_, &moved)) moved = ns;
  return time_from_ns(moved);
}

void MomentOrder::put(bool repeats, ltm::EntityUpdate& update, ReadingReport& report) {
  Time time = std::max(update.time, last_);
  if (time == last_ && at_last_.contains(update.entity)) time = time_from_ns(to_ns(last_) + 1);
  if (time != update.time)
    ++report.not_carried[repeats ? "repeated times, moved by 1 ns"
                                 : "times moved behind those before them"];
  if (time != last_) at_last_.clear();
  at_last_.insert(update.entity);
  last_ = update.time = time;
}

Result<std::optional<Time>> MomentsOfValues::next_time() {
  if (!waiting_) {
    ENGRAM_ASSIGN_OR_RETURN(waiting_, pull_());
  }
  return waiting_ ? std::optional(waiting_->time) : std::nullopt;
}

Status MomentsOfValues::take(ltm::Commit& commit) {
  ENGRAM_CHECK(waiting_, "no moment is left");
  const Time time = waiting_->time;
  while (waiting_ && waiting_->time == time) {
    commit.updates.push_back(*std::move(waiting_));
    waiting_.reset();
    ENGRAM_ASSIGN_OR_RETURN(waiting_, pull_());
  }
  return {};
}

Result<ltm::MemoryId> FreeEntities::take(const std::string& memory, const std::string& segment,
                                         const std::string& provider, const std::string& name) {
  for (int i = 1;; ++i) {
    const std::string unique = i == 1 ? name : fmt::format("{}_{}", name, i);
    ENGRAM_ASSIGN_OR_RETURN(const auto entity,
                            ltm::MemoryId::from_names({memory, segment, provider, unique}));
    if (take(entity)) return entity;
  }
}

Result<ltm::MemoryId> FreeEntities::take_own(std::string_view own, const std::string& memory,
                                             const std::string& segment,
                                             const std::string& provider, const std::string& name) {
  const ltm::MemoryId entity = own_entity(own);
  if (entity.is_entity() && take(entity)) return entity;
  return take(memory, segment, provider, name);
}

std::string name_of_topic(std::string_view topic, std::string_view other) {
  if (topic.starts_with('/')) topic.remove_prefix(1);
  std::string name(topic.empty() || !is_utf8(topic) ? other : topic);
  std::ranges::replace(name, '/', '.');
  return name;
}

ltm::MemoryId own_entity(std::string_view text) {
  const auto entity = ltm::MemoryId::parse(text);
  const bool is_usable = entity.ok() && entity->is_entity() && entity->names()[0] != "Recording";
  return is_usable ? *entity : ltm::MemoryId();
}

}  // namespace engram::datasets
