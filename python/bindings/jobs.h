// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

namespace engram::python {

// Jobs on a store, which run without the GIL. Each returns the report that `--json` of its command
// prints, as text. `progress`: see PythonProgress.
// Errors: exceptions of engram.errors.

/// Checks a store; returns the report of `engram check --json`.
std::string check(const std::string& store, bool is_deep, const pybind11::object& progress);

/// Reflects on a store; returns the report of `engram reflect --json`. `query` and `against` may be
/// empty. `commits` records what was found into the store.
std::string reflect(const std::string& store, const std::string& query, const std::string& against,
                    bool with_images, bool commits, const pybind11::object& progress);

/// Looks for what hands took and let go; returns the report of `engram notice --json`. `joints` may
/// be empty. `commits` writes it into the store.
std::string notice(const std::string& store, const std::string& joints, const std::string& open,
                   bool commits, const pybind11::object& progress);

/// Forgets snapshots; returns the report of `engram forget --json`. `config` is a file, or empty.
std::string forget(const std::string& store, const std::vector<std::string>& targets,
                   const std::string& config, bool is_dry_run, bool erases,
                   const pybind11::object& progress);

/// Consolidates a store; returns the report of `engram consolidate --json`. `options` are named
/// like the command's options, with underscores; durations and times are in ns.
std::string consolidate(const std::string& store, const pybind11::dict& options,
                        const pybind11::object& progress);

}  // namespace engram::python
