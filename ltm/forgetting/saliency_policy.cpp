// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/saliency_policy.h"

namespace engram::ltm {

namespace {

Status validate_share(const char* name, const std::optional<double>& share) {
  if (!share || (*share >= 0 && *share <= 1)) return {};
  return invalid_argument("{}: found {}, needs 0 to 1", name, *share);
}

}  // namespace

Status SaliencyPolicy::Options::validate() const {
  ENGRAM_RETURN_IF_ERROR(validate_share("below", below));
  ENGRAM_RETURN_IF_ERROR(validate_share("keep", keep));
  if (below && keep)
    return invalid_argument("saliency: found both 'below' and 'keep', needs one of them or none");
  return {};
}

std::string SaliencyPolicy::reason() const {
  if (options_.below) return fmt::format("saliency below {}", *options_.below);
  if (options_.keep) return fmt::format("saliency beyond the highest {:.6g} %", 100 * *options_.keep);
  return "lowest saliency";
}

Result<std::vector<ForgetProposal>> SaliencyPolicy::propose(ForgetSource& source,
                                                            const ForgetView& view) {
  const SaliencyTable& table = source.saliency();
  std::optional<SaliencyCut> cut;
  if (options_.below) cut = SaliencyCut{*options_.below, 0};
  if (options_.keep) cut = source.saliency_cut(match_, *options_.keep);
  std::vector<ForgetProposal> proposals;
  for (size_t i = 0; i < view.snapshots.size(); ++i) {
    if (!view.may_go[i]) continue;
    const auto value = table.find(view.entity, view.snapshots[i].time);
    if (value && (!cut || cut->takes(*value, view.snapshots[i].time)))
      proposals.push_back({i, *value});
  }
  return proposals;
}

}  // namespace engram::ltm
