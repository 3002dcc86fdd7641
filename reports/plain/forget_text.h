// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/forgetting/carry_out.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Prints what a plan takes: per entity how many, from when to when, why, and how much it frees.
void print_plan(const ltm::ForgetPlan& plan);

/// The same with the time of every snapshot that goes.
[[nodiscard]] Json plan_json(const ltm::ForgetPlan& plan);

void print_report(const ltm::ForgetReport& report);
[[nodiscard]] Json report_json(const ltm::ForgetReport& report);

}  // namespace engram::reports
