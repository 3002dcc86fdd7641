// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the process of a ProgramDetector.

#include <sys/types.h>

#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::ltm {

/// A child process that gets bytes and answers with lines. Nothing here waits longer than it is
/// told to, whatever the process does.
///
/// The kernel kills the process when the *thread* that started it ends, so that thread must live as
/// long as the process.
/// Threading: one thread, but for stop tokens.
class DetectorProcess {
 public:
  /// Longer lines are an error.
  static constexpr size_t kMaxLine = size_t{1} << 20;

  DetectorProcess() = default;
  DetectorProcess(const DetectorProcess&) = delete;
  DetectorProcess& operator=(const DetectorProcess&) = delete;
  ~DetectorProcess() { end(); }

  /// Starts a program in a process group of its own.
  /// Errors: kNotFound if there is no such program; kUnavailable.
  Status start(const std::vector<std::string>& command);

  /// Errors: kUnavailable if it has ended or does not read until then.
  Status write(std::span<const std::byte> bytes, SteadyTime until);

  /// Returns the next line of its output, without the line end.
  /// Errors: kUnavailable if it has ended, or wrote no whole line until then, or one that is too
  /// long; kCancelled on a stop.
  Result<std::string> read_line(SteadyTime until, const std::stop_token& stop = {});

  /// Closes its input, kills its process group after `grace` and waits for its end.
  void end(Duration grace = Duration(0));

 private:
  std::string program_;
  pid_t pid_ = -1;
  int in_ = -1;  ///< A socket, because writing to a dead process then raises no signal.
  int out_ = -1;
  std::string buffer_;
};

}  // namespace engram::ltm
