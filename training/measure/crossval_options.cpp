// SPDX-License-Identifier: Apache-2.0
#include "training/measure/crossval_options.h"

#include <algorithm>
#include <set>

namespace engram::training {

Status CrossvalOptions::validate() const {
  if (spacing < Duration::zero())
    return invalid_argument("time between measured snapshots: found {}, needs 0 or more",
                            engram::to_string(spacing));
  if (max_horizon < kMinHorizon || max_horizon > kMaxHorizon)
    return invalid_argument("largest horizon: found {} snapshots, needs {} to {}", max_horizon,
                            kMinHorizon, kMaxHorizon);
  if (std::ranges::find(folds, 0u) != folds.end())
    return invalid_argument("folds: found 0, the first is 1");
  if (std::set(folds.begin(), folds.end()).size() < folds.size())
    return invalid_argument("folds: found one twice, needs each at most once");
  if (variants.empty()) return invalid_argument("training variants: found none, needs at least 1");
  if (std::set(variants.begin(), variants.end()).size() < variants.size())
    return invalid_argument("training variants: found one twice, needs each at most once");
  ENGRAM_RETURN_IF_ERROR(representation(true).validate());
  return train.validate();
}

RepresentationOptions CrossvalOptions::representation(bool is_corrected) const {
  RepresentationOptions chosen;
  chosen.kind = is_corrected ? Representation::kCorrected : Representation::kLatents;
  chosen.bound_db = is_corrected ? bound_db : 0;
  chosen.refine_steps = refine_steps;
  return chosen;
}

}  // namespace engram::training
