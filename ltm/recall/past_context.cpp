// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/past_context.h"

#include "ltm/context/read_context.h"
#include "ltm/core/log.h"

namespace engram::ltm {

Result<SharedContext> EntityPast::context(const std::optional<idf::Type>& type) {
  ContextReader reader(type);
  ENGRAM_ASSIGN_OR_RETURN(std::optional<Time> time, first());
  while (time) {
    const auto snapshot = read(*time, Prefer::kRecorded);
    if (snapshot.status().code() == StatusCode::kUnavailable) return snapshot.status();
    reader.add(*time, snapshot.ok() ? std::span<const InstanceResult>(snapshot->answer.instances)
                                    : std::span<const InstanceResult>());
    if (to_ns(*time) == INT64_MAX) break;
    ENGRAM_ASSIGN_OR_RETURN(time, at_or_after(*time + Duration(1)));
  }
  return std::make_shared<const EntityContext>(std::move(reader).take());
}

EntityContext context_of_held(std::span<const SharedSnapshot> held,
                              const std::optional<idf::Type>& type) {
  ContextReader reader(type);
  std::vector<InstanceResult> instances;
  for (const SharedSnapshot& snapshot : held) {
    instances = result_of(*snapshot, {}, false).instances;
    reader.add(snapshot->time, instances);
  }
  return std::move(reader).take();
}

SharedContext join_contexts(SharedContext older, EntityContext newer) {
  if (newer.times.empty()) return older;
  ContextMerger merger;
  uint32_t i = 0;
  uint32_t j = 0;
  while (i < older->times.size() || j < newer.times.size()) {
    const bool is_newer =
        i == older->times.size() || (j < newer.times.size() && newer.times[j] <= older->times[i]);
    if (!is_newer) {
      merger.add(*older, i++);
      continue;
    }
    if (i < older->times.size() && older->times[i] == newer.times[j]) ++i;
    merger.add(newer, j++);
  }
  return std::make_shared<const EntityContext>(std::move(merger).take());
}

SharedContext context_at(const SharedContext& all, const TimeWindows& times) {
  ContextMerger merger;
  for (uint32_t i = 0; i < all->times.size(); ++i)
    if (times.contains(all->times[i])) merger.add(*all, i);
  return std::make_shared<const EntityContext>(std::move(merger).take());
}

SharedContext context_at(const SharedContext& all, std::span<const Time> times) {
  if (times.size() == all->times.size()) return all;  // Each is one of them.
  ContextMerger merger;
  auto next = times.begin();
  for (uint32_t i = 0; i < all->times.size(); ++i) {
    while (next != times.end() && *next < all->times[i]) ++next;
    if (next != times.end() && *next == all->times[i]) merger.add(*all, i);
  }
  return std::make_shared<const EntityContext>(std::move(merger).take());
}

}  // namespace engram::ltm
