// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "ltm/core/progress.h"

namespace engram::cli {

/// The form in which progress is shown.
enum class ProgressForm {
  kText,  ///< A line that is redrawn on a terminal, lines of text elsewhere.
  kJson,  ///< An object per line: time, what, done, total, detail, seconds_left.
  kNone,
};

/// Shows progress on stderr; every few seconds if stderr is no terminal, and never if messages are
/// turned off. In JSON, unknown values are null and `time` is UTC.
///
/// Threading: one thread. It must outlive the sink that it returns.
class ProgressLine {
 public:
  explicit ProgressLine(ProgressForm form = ProgressForm::kText);
  ~ProgressLine();

  [[nodiscard]] ProgressSink sink();

  /// Ends the line, so that other text can follow.
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
