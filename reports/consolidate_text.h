// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "reports/plain/output.h"
#include "training/night/consolidate.h"
#include "training/night/drop_raw.h"

namespace engram::reports {

/// The recorded snapshots of an entity that were dropped.
struct DroppedRaw {
  ltm::MemoryId entity;
  ltm::DropReport report;
  training::StageTime time;  ///< Time of verifying and dropping.
};

/// Prints what `engram consolidate` is going to do: a line per entity, the skipped ones last.
void print_plan(const training::ConsolidatePlan& plan);
[[nodiscard]] Json plan_json(const training::ConsolidatePlan& plan);

/// Prints what it did.
void print_report(const training::ConsolidateReport& report);
void print_dropped(const std::vector<DroppedRaw>& dropped);
[[nodiscard]] Json report_json(const training::ConsolidatePlan& plan,
                               const training::ConsolidateReport& report,
                               const std::vector<DroppedRaw>& dropped);

}  // namespace engram::reports
