// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

namespace engram::cli {

/// From now on Ctrl-C and SIGTERM ask for a stop; a second one ends the program at once.
void watch_for_interrupts();

/// Asks for a stop where the user did.
[[nodiscard]] std::stop_token interrupt_token();

}  // namespace engram::cli
