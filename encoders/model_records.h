// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

// What a model file holds beside its networks. Reading is safe on hostile files.
// Errors: kDataLoss where numbers are missing or out of their bounds.

/// "/codec": what the latents of images and the numbers are coded with.
Status write_codec(h5::File& file, const LatentBlockCodec& codec);
Status read_codec(const h5::File& file, const NetworkShape& shape, LatentBlockCodec& codec);

/// "/global_code": 8 bits per weight, a scale per number, the offset of each background. Absent
/// where the model has none.
Status write_global_code(h5::File& file, const GlobalCode& code);
Result<GlobalCode> read_global_code(const h5::File& file, const NetworkShape& shape);

/// "/condition": which numbers of another entity predictions start from.
Status write_condition(h5::File& file, const Condition& condition);
Result<Condition> read_condition(const h5::File& file, int count);

/// A group of gates and measured errors per horizon.
Status write_prediction(h5::File& file, const std::string& group, const PredictionRecord& record);
Result<PredictionRecord> read_prediction(const h5::File& file, const std::string& group);

/// The choice between models in "/provenance", in a file that has one already.
Status replace_choice(h5::File& file, const ModelChoice& choice);

/// "/provenance".
Status write_provenance(h5::File& file, const Provenance& from);
Result<Provenance> read_provenance(const h5::File& file);

}  // namespace engram::encoders
