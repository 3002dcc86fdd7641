// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/idf/type_xml.h"

namespace engram::cli {

/// Reads a value in the form that the file's extension names: .json or .idf (binary).
/// Errors: kNotFound, kUnavailable, kDataLoss, kInvalidArgument; each names the file.
Result<idf::Data> read_value(const std::filesystem::path& path);

/// Writes a value in the form that the file's extension names: .json or .idf (binary).
Status write_value(const idf::Data& value, const std::filesystem::path& path);

/// Finds a type of a file by its name.
/// Errors: kNotFound naming the existing types.
Result<idf::Type> find_type(const idf::TypeFile& file, std::string_view name);

}  // namespace engram::cli
