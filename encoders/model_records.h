// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

// What a model file holds beside its networks. Reading is safe on hostile files.
// Errors: kDataLoss where numbers are missing or out of their bounds.

/// "/tables": the frequencies that latents are coded with.
Status write_tables(h5::File& file, const LatentCoder& coder);
Result<LatentCoder> read_tables(const h5::File& file, std::vector<LatentGrid> grids);

/// "/prediction": gates and measured errors per horizon.
Status write_prediction(h5::File& file, const PredictionRecord& record);
Result<PredictionRecord> read_prediction(const h5::File& file);

/// "/provenance".
Status write_provenance(h5::File& file, const Provenance& from);
Result<Provenance> read_provenance(const h5::File& file);

}  // namespace engram::encoders
