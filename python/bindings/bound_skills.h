// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

namespace engram::python {

/// Defines SkillProvider and SkillRun, which engram.skills stands on.
void define_skills(pybind11::module_& module);

}  // namespace engram::python
