// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>

#include "ltm/idf/data.h"

namespace engram::python {

/// Converts a value to the Python objects that engram.idf.value describes. Arrays are read-only
/// views that keep their buffer alive; everything else is copied. Needs the GIL.
[[nodiscard]] pybind11::object to_python(const idf::Data& value);

/// Converts an array to a read-only view, which keeps the buffer alive. Needs the GIL.
[[nodiscard]] pybind11::array to_python(const idf::NdArray& array);

/// Converts a value from Python: anything that engram.idf.value accepts, or an object with
/// `to_idf()`. Arrays are copied, because their owner may change them. Needs the GIL.
/// Errors: engram.errors.InvalidArgumentError naming the path; any exception that `to_idf` raises.
[[nodiscard]] idf::Data from_python(const pybind11::handle& value);

}  // namespace engram::python
