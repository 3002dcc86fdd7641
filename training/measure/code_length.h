// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/store/store_reader.h"
#include "training/measure/evaluate_report.h"

// Private to this room.

namespace engram::training {

/// Compares the size of the image latents of a model with their ideal code length, over the first
/// few hundred snapshots in the store.
/// Errors: the errors of the store and of the model.
Result<CodeLength> measure_code_length(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                       const std::vector<ltm::SnapshotEntry>& index);

}  // namespace engram::training
