// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <deque>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram {

/// A child process that reads lines and answers with lines. It is terminated with this object.
///
/// Threading: one thread.
class LineProcess {
 public:
  LineProcess() = default;
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;
  ~LineProcess();

  /// `arguments` begins with the program, which is searched on the path.
  /// Errors: kNotFound where there is no such program; kUnavailable.
  Status start(const std::vector<std::string>& arguments);

  /// Errors: kUnavailable with its last lines where it has ended.
  Status write_line(const std::string& line);

  /// Returns the next line of its stdout or stderr, without the line end.
  /// Errors: kUnavailable with its last lines where it has ended, or writes no line for the time
  /// `patience`.
  Result<std::string> read_line(Duration patience);

 private:
  [[nodiscard]] std::string last_words() const;

  std::string program_;
  pid_t pid_ = -1;
  int in_ = -1;  ///< A socket, because writing to a dead process then raises no signal.
  int out_ = -1;
  std::string buffer_;
  std::deque<std::string> said_;  ///< The last lines that it wrote.
};

}  // namespace engram
