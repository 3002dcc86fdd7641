// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

namespace engram::cli {

/// Makes Ctrl-C and SIGTERM request a stop; a second one ends the program at once.
void watch_for_interrupts();

/// The token of which a stop is requested when the user interrupts the program.
[[nodiscard]] std::stop_token interrupt_token();

}  // namespace engram::cli
