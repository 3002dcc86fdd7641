// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/faults/session.h"

namespace engram::ltm::faults {

/// What is wrong with a store whose sessions told all this, one line each; empty where nothing is.
/// Reads it as it lies there, then lets a new writer take it over and seal it, and reads it again.
[[nodiscard]] std::vector<std::string> problems_of(const std::filesystem::path& store,
                                                   const std::vector<Told>& told);

/// Only the first half of that: changes nothing.
[[nodiscard]] std::vector<std::string> problems_of_reading(const std::filesystem::path& store,
                                                           const std::vector<Told>& told);

}  // namespace engram::ltm::faults
