// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <chrono>
#include <exception>
#include <stop_token>

#include "ltm/core/progress.h"
#include "python/bindings/errors.h"

namespace engram::python {

/// Tells a callable of Python how far a job is that runs without the GIL, and stops the job at
/// Ctrl-C or where the callable raises.
///
/// Threading: sink() from any thread, one at a time; the rest by who made it, with the GIL.
class PythonProgress {
 public:
  /// Called with (what, done, total, detail, seconds_left); or None.
  explicit PythonProgress(pybind11::object callable) : callable_(std::move(callable)) {}

  /// Lives as long as this.
  [[nodiscard]] ProgressSink sink();
  [[nodiscard]] std::stop_token stop() const { return stop_.get_token(); }

  /// Runs `work`, which gives a Result, without the GIL. Its value, or the exception that ended it.
  template <typename Work>
  auto run(Work work) {
    auto result = [&] {
      const pybind11::gil_scoped_release released;
      return work();
    }();
    if (failure_) std::rethrow_exception(failure_);
    return value_or_raise(std::move(result));
  }

 private:
  void tell(const Progress& progress);

  pybind11::object callable_;
  std::stop_source stop_;
  std::exception_ptr failure_;
  std::chrono::steady_clock::time_point told_{};
  std::string what_;
};

}  // namespace engram::python
