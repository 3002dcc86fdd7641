// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace engram::reports {

/// JSON whose members keep the order in which they were added, since people read reports.
using Json = nlohmann::ordered_json;

/// Writes a result to stdout, followed by a line break. Characters that a terminal would obey are
/// written as escapes, but line feeds stay: names in a text are shown by MemoryId::printable.
void print(const std::string& text);
/// The same of JSON, which stays exact.
void print_json(const Json& json);

}  // namespace engram::reports
