// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/robot/robot.h"

namespace engram::cli {

/// Quotes a text, or a list of texts, for robot.yaml.
[[nodiscard]] std::string quoted_yaml(const std::string& text);
[[nodiscard]] std::string quoted_yaml(const std::vector<std::string>& texts);

/// Prints where servers listen.
void tell_served(const server::Robot& robot, bool is_json);

/// Waits for Ctrl-C or SIGTERM.
void wait_for_the_end();

}  // namespace engram::cli
