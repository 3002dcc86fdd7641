// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/forget_options.h"

namespace engram::ltm {

Status ForgetRule::validate() const {
  if (!has_policy())
    return invalid_argument(
        "rule of '{}': has no policy, needs older_than, unread_for, read_less_than, importance, "
        "saliency or redundant",
        match.to_string());
  if (age) ENGRAM_RETURN_IF_ERROR(age->validate());
  if (access) ENGRAM_RETURN_IF_ERROR(access->validate());
  if (importance) ENGRAM_RETURN_IF_ERROR(importance->validate());
  if (saliency) ENGRAM_RETURN_IF_ERROR(saliency->validate());
  return redundancy ? redundancy->validate() : Status();
}

Result<std::vector<std::unique_ptr<ForgetPolicy>>> ForgetRule::policies(Time now) const {
  ENGRAM_RETURN_IF_ERROR(validate());
  std::vector<std::unique_ptr<ForgetPolicy>> made;
  if (age) made.push_back(std::make_unique<AgePolicy>(*age, now));
  if (access) made.push_back(std::make_unique<UnreadPolicy>(*access, now));
  if (importance) made.push_back(std::make_unique<ImportancePolicy>(*importance));
  if (saliency) made.push_back(std::make_unique<SaliencyPolicy>(*saliency, match));
  if (redundancy) {
    ENGRAM_ASSIGN_OR_RETURN(auto policy, RedundancyPolicy::create(*redundancy));
    made.push_back(std::move(policy));
  }
  return made;
}

std::string FadeStep::text() const {
  return psnr_db ? fmt::format("to {} dB", *psnr_db) : "to a gist";
}

Status FadeStep::validate() const {
  ENGRAM_RETURN_IF_ERROR(rule.validate());
  const bool is_possible = !psnr_db || (*psnr_db >= kMinPsnrDb && *psnr_db <= kMaxPsnrDb);
  if (is_possible) return {};
  return invalid_argument("fade: found a psnr of {}, needs {} to {} dB", *psnr_db, kMinPsnrDb,
                          kMaxPsnrDb);
}

Status ForgetOptions::validate() const {
  for (const FadeStep& step : fade) ENGRAM_RETURN_IF_ERROR(step.validate());
  if (fade.size() > kMaxFadeSteps)
    return invalid_argument("fade: found {} steps, needs {} at most", fade.size(), kMaxFadeSteps);
  for (const auto* list : {&rules, &first})
    for (const ForgetRule& rule : *list) ENGRAM_RETURN_IF_ERROR(rule.validate());
  if (!first.empty() && !max_bytes && !min_free_disk_bytes)
    return invalid_argument("quota: 'first' needs max_bytes or min_free_disk");
  const auto& younger = protection.younger_than;
  if (younger && *younger < Duration(0))
    return invalid_argument("younger_than: found {}, needs 0s or more", to_string(*younger));
  return {};
}

}  // namespace engram::ltm
