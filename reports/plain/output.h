// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace engram::reports {

/// Keeps members in the order in which they were added: people read reports.
using Json = nlohmann::ordered_json;

/// Writes a result to stdout, with the end of a line behind it.
void print(const std::string& text);
void print_json(const Json& json);

}  // namespace engram::reports
