// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace engram::reports {

/// JSON whose members keep the order in which they were added, since people read reports.
using Json = nlohmann::ordered_json;

/// Writes a result to stdout, followed by a line break.
void print(const std::string& text);
void print_json(const Json& json);

}  // namespace engram::reports
