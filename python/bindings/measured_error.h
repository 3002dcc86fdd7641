// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <cmath>
#include <optional>

#include "ltm/memory/source.h"

namespace engram::python {

/// The dict from which engram.snapshot.MeasuredError is built. Needs the GIL.
inline pybind11::object to_python(const ltm::MeasuredError& error) {
  namespace py = pybind11;
  const auto number_or_none = [](double value) {
    return std::isnan(value) ? py::object(py::none()) : py::object(py::float_(value));
  };
  py::dict dict;
  dict["image_mse"] = number_or_none(error.image_mse);
  dict["number_mse"] = number_or_none(error.number_mse);
  return dict;
}

inline pybind11::object to_python(const std::optional<ltm::MeasuredError>& error) {
  return error ? to_python(*error) : pybind11::none();
}

}  // namespace engram::python
