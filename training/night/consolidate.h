// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "training/night/consolidate_options.h"
#include "training/night/consolidate_plan.h"
#include "training/night/consolidate_report.h"

namespace engram::training {

/// Receives the plan before anything is trained.
using PlanSink = std::function<void(const ConsolidatePlan&)>;

/// Returns what consolidate() would do. It reads the recorded snapshots and writes nothing.
/// Errors: those of consolidate() before it trains.
Result<ConsolidatePlan> plan_consolidation(const std::filesystem::path& store,
                                           const ConsolidateOptions& options,
                                           const std::stop_token& stop);

/// The offline phase: trains a model per entity, encodes the entity's recorded snapshots with it,
/// measures the values decoded from the stored bytes, and publishes model and latents together.
///
/// An entity that cannot be a tensor is skipped with its reason. Entities are published one by one.
/// If the job is killed at any moment, each entity in the store is either published or unchanged,
/// and a new job continues training from the last checkpoint. The job can run beside a live writer.
/// Errors: kInvalidArgument; kNotFound if no entity matches; kCancelled on `stop`; the errors of
/// the store.
/// Threading: one at a time per process (train_model).
Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop,
                                      const PlanSink& plan = {});

}  // namespace engram::training
