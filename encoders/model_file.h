// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "encoders/provenance.h"
#include "ltm/core/status.h"
#include "ltm/idf/layout.h"

namespace engram::encoders {

/// Version of the format of model files that this program reads and writes.
inline constexpr int kModelFormatVersion = 5;

/// Reads the provenance of a model without its networks.
/// Errors: kNotFound; kDataLoss if the file is damaged; kFailedPrecondition if its format version
/// is another one.
Result<Provenance> read_provenance(const std::filesystem::path& path);

/// Reads the layout of the values of a model without its networks.
/// Errors: as for read_provenance.
Result<idf::Layout> read_layout(const std::filesystem::path& path);

}  // namespace engram::encoders
