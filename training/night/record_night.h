// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/store/night_records.h"
#include "training/night/consolidate_plan.h"
#include "training/night/consolidate_report.h"

// Private to this room.

namespace engram::training {

/// Writes down what a job did, as far as it came. Entities of which the plan says that there is
/// nothing to be done are left out. A night does not fail for its record: a warning says that it
/// could not be written.
void record_night(ltm::NightAccount account, const ConsolidatePlan& plan,
                  const ConsolidateReport& report, const Status& ended);

}  // namespace engram::training
