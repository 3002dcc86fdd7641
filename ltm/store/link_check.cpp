// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/link_check.h"

#include "ltm/memory/links.h"

namespace engram::ltm {

namespace {

/// Max number of link targets that are remembered; it bounds memory.
constexpr size_t kMaxTargets = 10'000;

}  // namespace

void LinkCheck::add(const PackedSnapshot& snapshot, const SegmentTypes& types,
                    const std::string& file) {
  const idf::Type* type = types.of_entity(snapshot.entity);
  if (type == nullptr) return;
  for (const PackedInstance& instance : snapshot.instances) {
    for (const Link& link : find_links(instance.value.rest, *type)) {
      if (!link.id.has_entity()) continue;
      const MemoryId target = link.id.entity();
      if (targets_.size() >= kMaxTargets && !targets_.contains(target)) continue;
      Place& place = targets_[target];
      if (place.links++ > 0) continue;
      place.file = file;
      place.snapshot = snapshot.entity.at(snapshot.time).to_string();
    }
  }
}

std::vector<Finding> LinkCheck::findings() const {
  std::vector<Finding> notes;
  for (const auto& [target, place] : targets_) {
    if (entities_.contains(target)) continue;
    notes.push_back({Severity::kNote, place.file, place.snapshot,
                     fmt::format("{} links lead to '{}', which is not in the store", place.links,
                                 target.to_string()),
                     "nothing, where the entity lives in another store"});
  }
  return notes;
}

}  // namespace engram::ltm
