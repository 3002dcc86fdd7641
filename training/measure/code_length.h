// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/store/store_reader.h"
#include "training/measure/evaluate_report.h"

// Private to this room.

namespace engram::training {

/// Measures what the latents of images of a model take beside what probabilities say, over the
/// first few hundred snapshots in the store.
/// Errors: those of the store and of the model.
Result<CodeLength> measure_code_length(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                       const std::vector<ltm::SnapshotEntry>& index);

}  // namespace engram::training
