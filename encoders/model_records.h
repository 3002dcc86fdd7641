// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

// The records that a model file holds beside its networks. Reading is safe on hostile files.
// Errors: kDataLoss if numbers are missing or out of range.

/// "/codec": the parameters of the codecs of image latents and numbers, and the references of
/// videos.
Status write_codec(h5::File& file, const LatentBlockCodec& codec);
Status read_codec(const h5::File& file, const NetworkShape& shape, LatentBlockCodec& codec);

/// "/global_code": 8 bits per weight, a scale per number, the offset of each background. Absent if
/// the model has no global code.
Status write_global_code(h5::File& file, const GlobalCode& code);
Result<GlobalCode> read_global_code(const h5::File& file, const NetworkShape& shape);

/// "/condition": the numbers of another entity that condition predictions.
Status write_condition(h5::File& file, const Condition& condition);
Result<Condition> read_condition(const h5::File& file, int count);

/// A group with the gates and measured errors of each horizon.
Status write_prediction(h5::File& file, const std::string& group, const PredictionRecord& record);
Result<PredictionRecord> read_prediction(const h5::File& file, const std::string& group);

}  // namespace engram::encoders
