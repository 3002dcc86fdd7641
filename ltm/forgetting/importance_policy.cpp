// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/importance_policy.h"

#include <algorithm>
#include <cmath>

namespace engram::ltm {

Status ImportancePolicy::Options::validate() const {
  if (below && !std::isfinite(*below))
    return invalid_argument("below: found {}, needs a finite number", *below);
  return {};
}

std::string ImportancePolicy::reason() const {
  const std::string what = options_.path.empty() ? "confidence" : "'" + options_.path + "'";
  return options_.below ? fmt::format("{} below {}", what, *options_.below) : "least " + what;
}

Result<std::optional<double>> ImportancePolicy::importance(ForgetSource& source,
                                                           const MemoryId& entity,
                                                           const SnapshotEntry& entry) const {
  std::optional<double> max;
  if (options_.path.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(max, source.confidence(entity, entry));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const Snapshot snapshot, source.read(entity, entry));
    for (const Instance& instance : snapshot.instances) {
      const idf::Data* part = instance.data.at(options_.path);
      const auto number = part == nullptr ? std::nullopt : part->as_number();
      if (!number || std::isnan(*number)) return std::optional<double>();
      max = std::max(max.value_or(*number), *number);
    }
  }
  return max && std::isnan(*max) ? std::nullopt : max;
}

Result<std::vector<ForgetProposal>> ImportancePolicy::propose(ForgetSource& source,
                                                              const ForgetView& view) {
  std::vector<ForgetProposal> proposals;
  for (size_t i = 0; i < view.snapshots.size(); ++i) {
    if (!view.may_go[i]) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto value, importance(source, view.entity, view.snapshots[i]));
    if (value && (!options_.below || *value < *options_.below)) proposals.push_back({i, *value});
  }
  return proposals;
}

}  // namespace engram::ltm
