// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/provenance.h"
#include "ltm/store/manifest.h"
#include "reports/plain/output.h"
#include "training/measure/stored_snapshots.h"

namespace engram::reports {

/// A model of a store, with its provenance.
struct StoredModel {
  const ltm::ModelInfo* info = nullptr;
  encoders::Provenance from;
};

/// Prints what a model was trained on, and the bytes of each form of its images.
void print_model(const StoredModel& model);
[[nodiscard]] Json model_json(const StoredModel& model);

/// Reports in which form a snapshot is kept, with its bytes and errors.
[[nodiscard]] Json stored_snapshot_json(const ltm::MemoryId& entity,
                                        const training::StoredSnapshot& snapshot);

}  // namespace engram::reports
