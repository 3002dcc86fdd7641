// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/output.h"

#include <fmt/format.h>

namespace engram::reports {

void print(const std::string& text) {
  fmt::print("{}\n", text);
}

void print_json(const Json& json) {
  print(json.dump(2));
}

}  // namespace engram::reports
