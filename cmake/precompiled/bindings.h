// SPDX-License-Identifier: Apache-2.0
// What the sources of the Python module include.
#pragma once

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "standard.h"
