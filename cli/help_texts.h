// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "ltm/core/status.h"

namespace engram::cli {

/// Writes what `--help` says of the program and of each of its commands into a directory, a file
/// each: help.txt, help.query.txt, help.idf.generate.txt. The launcher tells them; usage.txt lets
/// it tell wrong usage, too. Errors: kUnavailable naming the file that cannot be written.
[[nodiscard]] Status write_help_texts(CLI::App& app, const std::filesystem::path& directory);

}  // namespace engram::cli
