// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/provenance.h"
#include "ltm/h5/h5.h"

// Private to this room.

namespace engram::encoders {

// The record of how a model was made. Reading is safe on hostile files.
// Errors: kDataLoss if numbers are missing or out of range.

/// Replaces the choice between models in the "/provenance" of an existing file.
Status replace_choice(h5::File& file, const ModelChoice& choice);

/// "/provenance": see Provenance.
Status write_provenance(h5::File& file, const Provenance& from);
Result<Provenance> read_provenance(const h5::File& file);

}  // namespace engram::encoders
