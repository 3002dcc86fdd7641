// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace engram::experiments {

/// Options of every program that measures with a stream.
struct StreamOptions {
  double seconds = 40;       ///< Length of the stream.
  size_t frames = 904;       ///< Maximum number of frames in memory, 0.9 MB each.
  std::string dir = "bars";  ///< Folder for files, which are made new.
  std::string json = {};     ///< File for all figures; none if empty.

  /// Adds --seconds, --frames, --dir and --json. This must outlive the parsing.
  void add_to(CLI::App& app);
};

/// Adds an option such as "--paced-seconds". Unit: s.
void add_seconds(CLI::App& app, const std::string& name, double& seconds, const std::string& what);

}  // namespace engram::experiments
