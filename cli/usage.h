// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace engram::cli {

/// All commands of a program with their options, as a text that read_usage() makes a program of
/// that takes the same words: which there are, how many values each has, which are required and
/// which exclude one another. What values mean is not in it.
[[nodiscard]] std::string usage_text(const CLI::App& app);

/// Makes `app`, which has nothing yet, the program of a text; false where it is no such text.
[[nodiscard]] bool read_usage(const std::string& text, CLI::App& app);

/// What the program would say of arguments that it does not take, on stderr; empty where it takes
/// them, or where what it says depends on more than their words.
/// `app`: of read_usage(). Errors of values are told before all that lacks or is too much, so with
/// one that the program checks nothing is known.
[[nodiscard]] std::string wrong_usage_text(CLI::App& app, std::vector<std::string> arguments);

}  // namespace engram::cli
