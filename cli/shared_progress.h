// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/progress_line.h"

namespace engram::cli {

/// Shows the progress of several children, which report theirs as JSON, in one line.
///
/// Threading: one thread.
class SharedProgress {
 public:
  /// `line` must outlive this object.
  SharedProgress(size_t children, ProgressLine& line)
      : last_(children), line_(line), sink_(line.sink()) {}

  /// Takes a line of a child's stderr: progress, or a message, which is passed on.
  void tell(size_t child, const std::string& line, bool passes_on);

 private:
  [[nodiscard]] Progress united() const;

  std::vector<Progress> last_;
  ProgressLine& line_;
  ProgressSink sink_;
};

}  // namespace engram::cli
