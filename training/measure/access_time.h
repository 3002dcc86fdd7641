// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"
#include "training/measure/evaluate_report.h"

// Private to this room.

namespace engram::training {

/// Measures the time to read and decode latents of a model.
/// Errors: the errors of the store and of the model.
Result<AccessTimes> measure_access(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                   const std::vector<ltm::SnapshotEntry>& index,
                                   ltm::Encoder& encoder);

}  // namespace engram::training
