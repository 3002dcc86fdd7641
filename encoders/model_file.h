// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "encoders/provenance.h"
#include "ltm/core/status.h"
#include "ltm/idf/layout.h"

namespace engram::encoders {

/// The format of model files that this program reads and writes.
inline constexpr int kModelFormatVersion = 5;

/// Reads where a model comes from, without its networks.
/// Errors: kNotFound; kDataLoss where the file is damaged; kFailedPrecondition where its format is
/// another.
Result<Provenance> read_provenance(const std::filesystem::path& path);

/// Reads the layout of the values that a model is of, without its networks.
/// Errors: as read_provenance.
Result<idf::Layout> read_layout(const std::filesystem::path& path);

}  // namespace engram::encoders
