// SPDX-License-Identifier: Apache-2.0
#include "store/stream_options.h"

namespace engram::experiments {

void StreamOptions::add_to(CLI::App& app) {
  add_seconds(app, "--seconds", seconds, "length of the stream");
  app.add_option("--frames", frames, "most decoded frames in memory, 0.9 MB each")
      ->check(CLI::Range(2, 20000))
      ->capture_default_str();
  app.add_option("--dir", dir, "where files are made anew")->capture_default_str();
  app.add_option("--json", json, "file for all figures");
}

void add_seconds(CLI::App& app, const std::string& name, double& seconds, const std::string& what) {
  app.add_option(name, seconds, what)->check(CLI::Range(1.0, 3600.0))->capture_default_str();
}

}  // namespace engram::experiments
