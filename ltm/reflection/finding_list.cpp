// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/finding_list.h"

#include <algorithm>
#include <iterator>
#include <ranges>
#include <tuple>

namespace engram::ltm {

void FindingList::add(ReflectionFinding finding, Duration close) {
  std::vector<ReflectionFinding>& known = found_[{finding.entity, finding.kind}];
  // Findings of one member come in the order of time; those of others may lie between them.
  constexpr size_t kLookedBack = 64;
  const size_t last = known.size() - std::min(known.size(), kLookedBack);
  for (size_t i = known.size(); i > last; --i) {
    ReflectionFinding& before = known[i - 1];
    const bool is_near =
        finding.first <= before.last + close && before.first <= finding.last + close;
    if (before.member != finding.member || before.severity != finding.severity || !is_near)
      continue;
    before.first = std::min(before.first, finding.first);
    before.last = std::max(before.last, finding.last);
    before.count += finding.count;
    return;
  }
  if (known.size() >= kMaxTold) {
    ++untold_;
    return;
  }
  known.push_back(std::move(finding));
}

bool FindingList::has(ReflectionKind kind, const MemoryId& entity, Time first, Time last) const {
  const auto known = found_.find({entity, kind});
  if (known == found_.end()) return false;
  return std::ranges::any_of(known->second, [&](const ReflectionFinding& finding) {
    return finding.first <= last && first <= finding.last;
  });
}

std::vector<ReflectionFinding> FindingList::take(uint64_t& untold) {
  std::vector<ReflectionFinding> all;
  for (auto& known : found_ | std::views::values) std::ranges::move(known, std::back_inserter(all));
  std::ranges::stable_sort(all, [](const ReflectionFinding& a, const ReflectionFinding& b) {
    if (a.severity != b.severity) return a.severity == Severity::kFault;
    if (a.entity != b.entity) return a.entity < b.entity;
    return std::tuple(a.first, a.kind) < std::tuple(b.first, b.kind);
  });
  untold = untold_;
  found_.clear();
  return all;
}

}  // namespace engram::ltm
