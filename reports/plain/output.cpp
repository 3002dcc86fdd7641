// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/output.h"

#include <fmt/format.h>

#include "ltm/core/printable.h"

namespace engram::reports {

void print(const std::string& text) {
  fmt::print("{}\n", printable_lines(text));
}

void print_json(const Json& json) {
  fmt::print("{}\n", printable_json(json.dump(2)));
}

}  // namespace engram::reports
