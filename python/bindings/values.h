// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include "ltm/idf/data.h"

namespace engram::python {

/// A value as engram.idf.value describes it. Arrays are views that cannot be written and keep the
/// buffer that they look at; nothing else is shared. Needs the GIL.
[[nodiscard]] pybind11::object to_python(const idf::Data& value);

}  // namespace engram::python
