// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <deque>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/child.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram {

/// A child process that gets bytes and answers with lines. It is killed with this object, and so
/// are its own children.
///
/// Threading: one thread, but for stop tokens.
class LineProcess {
 public:
  struct Options {
    /// Whether the lines are those of its stderr, too, so that they are among its last ones where
    /// it fails. Otherwise it writes errors where this process does.
    bool has_errors = true;
    ChildLife life = ChildLife::kItsOwn;
    /// Longer lines are an error. Unit: bytes.
    size_t max_line = size_t{1} << 30;
  };

  LineProcess() = default;
  LineProcess(const LineProcess&) = delete;
  LineProcess& operator=(const LineProcess&) = delete;
  ~LineProcess() { end(); }

  /// Ends the process that there is, and starts another one. `arguments` begins with the program,
  /// which is searched on the path.
  /// Errors: kNotFound where there is no such program; kUnavailable.
  Status start(const std::vector<std::string>& arguments) { return start(arguments, Options()); }
  Status start(const std::vector<std::string>& arguments, const Options& options);

  /// Errors: kUnavailable with its last lines where it has ended, or does not read until then.
  Status write(std::span<const std::byte> bytes, SteadyTime until);
  Status write_line(const std::string& line, SteadyTime until = SteadyTime::max());

  /// Returns the next line of what it wrote, without the line end.
  /// Errors: kUnavailable with its last lines where it has ended, or wrote no whole line until
  /// then, or one that is too long; kCancelled on a stop.
  Result<std::string> read_line(SteadyTime until, const std::stop_token& stop = {});
  Result<std::string> read_line(Duration patience) { return read_line(steady_now() + patience); }

  /// Closes its input, kills its process group after `grace` and waits for its end.
  void end(Duration grace = Duration(0));

 private:
  Status take_more(SteadyTime until, const std::stop_token& stop);
  [[nodiscard]] bool has_ended() const;
  [[nodiscard]] std::string last_words() const;

  Options options_;
  std::string program_;
  pid_t pid_ = -1;
  int in_ = -1;  ///< A socket, because writing to a dead process then raises no signal.
  int out_ = -1;
  std::string buffer_;
  std::deque<std::string> said_;  ///< The last lines that it wrote.
};

}  // namespace engram
