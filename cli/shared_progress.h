// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/progress_line.h"

namespace engram::cli {

/// One line for what several children do, which tell their progress as JSON.
///
/// Threading: one thread.
class SharedProgress {
 public:
  /// The line outlives it.
  SharedProgress(size_t children, ProgressLine& line)
      : last_(children), line_(line), sink_(line.sink()) {}

  /// A line of a child's stderr: progress, or a message, which is passed on.
  void tell(size_t child, const std::string& line, bool passes_on);

 private:
  [[nodiscard]] Progress united() const;

  std::vector<Progress> last_;
  ProgressLine& line_;
  ProgressSink sink_;
};

}  // namespace engram::cli
