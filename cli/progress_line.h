// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "ltm/core/progress.h"

namespace engram::cli {

/// How progress is shown.
enum class ProgressForm {
  kText,  ///< A line that redraws itself on a terminal, lines of text elsewhere.
  kJson,  ///< An object per line: time, what, done, total, detail, seconds_left.
  kNone,
};

/// Shows progress on stderr, every few seconds where it is no terminal; nothing where messages are
/// turned off. As JSON, what nobody knows is null, and `time` is UTC.
///
/// Threading: one thread. Outlives the sink that it gives.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressForm form = ProgressForm::kText);
  ~ProgressLine();

  [[nodiscard]] ProgressSink sink();

  /// Ends the line, so that other text may follow.
  void finish();

 private:
  void show(const Progress& progress);

  using WallClock = std::chrono::steady_clock;
  bool is_quiet_;
  bool is_json_;
  bool is_redrawn_;
  bool is_open_ = false;
  std::string what_;
  bool is_waiting_ = false;
  WallClock::time_point last_{};
};

}  // namespace engram::cli
