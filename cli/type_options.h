// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "ltm/recording/recorder.h"

namespace engram::cli {

/// The types of segments, unparsed.
struct TypeArguments {
  std::vector<std::string> files;
  std::vector<std::string> types;  ///< Each is "SEGMENT=NAME".
};

struct DeclaredType {
  ltm::MemoryId segment;
  idf::Type type;
};

/// Adds --types and --type.
void add_type_options(CLI::App& command, TypeArguments& arguments);

/// Reads the types.
/// Errors: those of read_type_file; kInvalidArgument naming the option and the existing types.
Result<std::vector<DeclaredType>> read_types(const TypeArguments& arguments);

/// Declares the types at a recorder.
/// Errors: those of Recorder::declare.
Status declare(ltm::Recorder& recorder, const std::vector<DeclaredType>& types);

}  // namespace engram::cli
