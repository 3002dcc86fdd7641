// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "ltm/recording/recorder.h"

namespace engram::cli {

/// Which segments have which types.
struct TypeArguments {
  std::vector<std::string> files;
  std::vector<std::string> types;  ///< "SEGMENT=NAME".
};

struct DeclaredType {
  ltm::MemoryId segment;
  idf::Type type;
};

/// Adds --types and --type.
void add_type_options(CLI::App& command, TypeArguments& arguments);

/// Errors: those of read_type_file; kInvalidArgument naming the option and the types there are.
Result<std::vector<DeclaredType>> read_types(const TypeArguments& arguments);

/// Errors: those of Recorder::declare.
Status declare(ltm::Recorder& recorder, const std::vector<DeclaredType>& types);

}  // namespace engram::cli
