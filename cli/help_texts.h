// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "ltm/core/status.h"

namespace engram::cli {

/// Writes the help text of the program and of each command into a directory, a file each: help.txt,
/// help.query.txt, help.idf.generate.txt. The launcher prints them. usage.txt lets it report wrong
/// usage too.
/// Errors: kUnavailable naming the file that cannot be written.
[[nodiscard]] Status write_help_texts(CLI::App& app, const std::filesystem::path& directory);

}  // namespace engram::cli
