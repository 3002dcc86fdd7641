// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace engram::cli {

/// Asks on the terminal. Returns false unless the answer is yes, or if Ctrl-C comes first.
[[nodiscard]] bool is_confirmed(const std::string& question);

}  // namespace engram::cli
