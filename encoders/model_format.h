// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "ltm/core/status.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/layout.h"

// Private to this room.

namespace engram::encoders {

/// What the attribute "format" of a model file says.
inline constexpr std::string_view kModelFormat = "engram model";

/// Opens a model file and checks its format.
/// Errors: kNotFound; kDataLoss if it is damaged or no model; kFailedPrecondition if its format
/// version is another one.
Result<h5::File> open_model_file(const std::filesystem::path& path);

/// Turns an error of reading a broken file into one that names the file and says that it is
/// damaged.
Status damaged_model(const Status& status, const std::filesystem::path& path);

/// Reads the layout of the values of a model.
/// Errors: kDataLoss.
Result<idf::Layout> read_layout(const h5::File& file);

}  // namespace engram::encoders
