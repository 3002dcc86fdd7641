// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>

#include "ltm/idf/data.h"

namespace engram::python {

/// A value as engram.idf.value describes it. Arrays are views that cannot be written and keep the
/// buffer that they look at; nothing else is shared. Needs the GIL.
[[nodiscard]] pybind11::object to_python(const idf::Data& value);

/// The buffer lives as long as the array, or a view of it. Needs the GIL.
[[nodiscard]] pybind11::array to_python(const idf::NdArray& array);

/// What engram.idf.value takes for a value, and objects with `to_idf()`. Arrays are copied: who
/// gave them may change them. Needs the GIL.
/// Errors: engram.errors.InvalidArgumentError naming the path; what `to_idf` raises.
[[nodiscard]] idf::Data from_python(const pybind11::handle& value);

}  // namespace engram::python
