// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/forgetting/carry_out.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Prints what a plan forgets: per entity the number of snapshots, their time span, the reason and
/// the bytes that it frees.
void print_plan(const ltm::ForgetPlan& plan);

/// What is true of a plan as a whole.
[[nodiscard]] Json plan_sums_json(const ltm::ForgetPlan& plan);
/// What a plan does to one entity, in counts and bytes.
[[nodiscard]] Json planned_entity_json(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan);

/// Like print_plan(), with the time of every snapshot that is forgotten.
[[nodiscard]] Json plan_json(const ltm::ForgetPlan& plan);

void print_report(const ltm::ForgetReport& report);
[[nodiscard]] Json report_json(const ltm::ForgetReport& report);

}  // namespace engram::reports
