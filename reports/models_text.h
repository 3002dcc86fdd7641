// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/provenance.h"
#include "ltm/store/manifest.h"
#include "reports/plain/output.h"
#include "training/measure/stored_snapshots.h"

namespace engram::reports {

/// A model of a store and where it comes from.
struct StoredModel {
  const ltm::ModelInfo* info = nullptr;
  encoders::Provenance from;
};

/// What it was trained on, and what each form of its images takes.
void print_model(const StoredModel& model);
[[nodiscard]] Json model_json(const StoredModel& model);

/// In which form a snapshot is kept, its bytes and errors.
[[nodiscard]] Json stored_snapshot_json(const ltm::MemoryId& entity,
                                        const training::StoredSnapshot& snapshot);

}  // namespace engram::reports
