// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace engram::cli {

/// Describes all commands and options of a program as a text, from which read_usage() builds a
/// program that accepts the same words: the options, how many values each has, which are required
/// and which exclude one another. The meaning of values is not included.
[[nodiscard]] std::string usage_text(const CLI::App& app);

/// Adds the commands of a text to `app`, which must be empty. Returns false if the text is not
/// valid.
[[nodiscard]] bool read_usage(const std::string& text, CLI::App& app);

/// Returns the program's message on stderr for arguments that it refuses; empty if it accepts them,
/// or if its message depends on more than their words. `app` comes from read_usage(). The program
/// reports an invalid value before missing or surplus words, so nothing is known about arguments
/// with a value that the program validates.
[[nodiscard]] std::string wrong_usage_text(CLI::App& app, std::vector<std::string> arguments);

}  // namespace engram::cli
