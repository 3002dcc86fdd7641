// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/python_progress.h"

namespace engram::python {

namespace py = pybind11;

ProgressSink PythonProgress::sink() {
  return [this](const Progress& progress) { tell(progress); };
}

void PythonProgress::tell(const Progress& progress) {
  // Each call takes the GIL and may hold up the program's other threads, so only the first and last
  // report of each piece of work and 20 per second go to Python.
  constexpr auto kBetween = std::chrono::milliseconds(50);
  const auto now = std::chrono::steady_clock::now();
  const bool is_new = progress.what != what_;
  const bool is_last = progress.total > 0 && progress.done >= progress.total;
  if (failure_ || (!is_new && !is_last && now - told_ < kBetween)) return;
  told_ = now;
  what_ = progress.what;
  const py::gil_scoped_acquire acquired;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callable_.is_none()) return;
    callable_(progress.what, progress.done, progress.total, progress.detail,
              progress.seconds_left < 0 ? py::object(py::none())
                                        : py::object(py::float_(progress.seconds_left)));
  } catch (const py::error_already_set&) {
    failure_ = std::current_exception();
    stop_.request_stop();
  }
}

}  // namespace engram::python
