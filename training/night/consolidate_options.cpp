// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate_options.h"

namespace engram::training {

Status ConsolidateOptions::validate() const {
  if (min_snapshots < 2)
    return invalid_argument("smallest number of snapshots: found {}, needs 2", min_snapshots);
  if (access < Duration::zero())
    return invalid_argument("time to decode any image: found {}, needs 0 or more",
                            engram::to_string(access));
  ENGRAM_RETURN_IF_ERROR(representation.validate());
  ENGRAM_RETURN_IF_ERROR(job.validate());
  if (job.until && train.steps)
    return invalid_argument("needs an end or a number of steps, not both");
  return train.validate();
}

}  // namespace engram::training
