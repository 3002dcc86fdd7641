// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "ltm/core/progress.h"

namespace engram::cli {

/// Shows progress on stderr: one line that redraws itself on a terminal, plain lines every few
/// seconds elsewhere, nothing where messages are turned off.
///
/// Threading: one thread. Outlives the sink that it gives.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();

  [[nodiscard]] ProgressSink sink();

  /// Ends the line, so that other text may follow.
  void finish();

 private:
  void show(const Progress& progress);

  using WallClock = std::chrono::steady_clock;
  bool is_quiet_;
  bool is_terminal_;
  bool is_open_ = false;
  std::string what_;
  WallClock::time_point last_{};
};

}  // namespace engram::cli
