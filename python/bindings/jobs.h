// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace engram::python {

// Jobs on a store, without the GIL. Reports are those that `--json` of the commands prints, as
// text. `progress`: see PythonProgress. Errors: exceptions of engram.errors.

/// What `engram check --json` prints.
std::string check(const std::string& store, bool is_deep, const pybind11::object& progress);

/// What `engram forget --json` prints. `config`: a file, or nothing.
std::string forget(const std::string& store, const std::vector<std::string>& targets,
                   const std::string& config, bool is_dry_run, const pybind11::object& progress);

/// What `engram consolidate --json` prints. `options` by the names of the command's options, with
/// underscores; durations and times in ns.
std::string consolidate(const std::string& store, const pybind11::dict& options,
                        const pybind11::object& progress);

}  // namespace engram::python
