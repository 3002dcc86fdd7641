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

/// Reports the progress of a job that runs without the GIL to a Python callable. Ctrl-C, or an
/// exception of the callable, stops the job.
///
/// Threading: the sink may be called from any thread, one call at a time; everything else by the
/// creating thread, with the GIL.
class PythonProgress {
 public:
  /// `callable` is called with (what, done, total, detail, seconds_left); it may be None.
  explicit PythonProgress(pybind11::object callable) : callable_(std::move(callable)) {}

  /// The sink is valid as long as this object.
  [[nodiscard]] ProgressSink sink();
  [[nodiscard]] std::stop_token stop() const { return stop_.get_token(); }

  /// Runs `work`, which returns a Result, without the GIL. Returns its value, or raises the
  /// exception that ended it.
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
