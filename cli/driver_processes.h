// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::cli {

/// A program that runs beside this one, and is started again when it ends.
struct DriverProcess {
  std::string name;
  /// The program, which is looked up on PATH, and its arguments.
  std::vector<std::string> arguments;
  /// Whether it sees by itself that all is over; others are told by SIGTERM.
  bool ends_by_itself = false;
};

struct DriverEvents {
  /// Told every line of a driver's stdout, without the line break.
  std::function<void(const std::string& driver, const std::string& line)> on_line;
  /// Told that a driver ended and when it is started again. `exit_code`: 128 plus the signal if a
  /// signal ended it.
  std::function<void(const std::string& driver, int exit_code, Duration again)> on_end;
  /// Whether drivers that end have done what they had to.
  std::function<bool()> is_over;
  /// Called many times a second.
  std::function<void()> on_look = [] {};
};

/// Runs drivers until all has been done or a stop is requested, and waits until they have ended:
/// those that do not see it by themselves are told by SIGTERM, and they are killed after two
/// seconds. The kernel kills them with the thread that calls this, also if that is killed. Errors:
/// kUnavailable or kNotFound if one cannot be started; the others are ended then. Threading: events
/// come on the calling thread.
Status run_drivers(const std::vector<DriverProcess>& drivers, const DriverEvents& events,
                   const std::stop_token& stop);

}  // namespace engram::cli
