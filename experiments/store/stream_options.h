// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace engram::experiments {

/// What every program that measures with a stream is told.
struct StreamOptions {
  double seconds = 40;       ///< Length of the stream.
  size_t frames = 904;       ///< Most that are decoded in memory, 0.9 MB each.
  std::string dir = "bars";  ///< Where files are made anew.
  std::string json = {};     ///< For all figures; empty: none.

  /// --seconds, --frames, --dir, --json; these must outlive the parsing.
  void add_to(CLI::App& app);
};

/// "--paced-seconds" and the like. Unit: s.
void add_seconds(CLI::App& app, const std::string& name, double& seconds, const std::string& what);

}  // namespace engram::experiments
