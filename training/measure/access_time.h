// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"
#include "training/measure/evaluate_report.h"

// Private to this room.

namespace engram::training {

/// Measures how long latents of a model take to be read and decoded.
/// Errors: those of the store and of the model.
Result<AccessTimes> measure_access(ltm::StoreReader& reader, const ltm::ModelInfo& model,
                                   const std::vector<ltm::SnapshotEntry>& index,
                                   ltm::Encoder& encoder);

}  // namespace engram::training
