// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>

namespace engram::cli {

/// Makes Ctrl-C and SIGTERM request a stop. The program ends within a second of it, whatever it
/// does: what it writes is published whole or not at all, so it may be cut off anywhere. A second
/// signal ends it at once.
/// Source: docs/reliability.md, section "Ctrl-C".
void watch_for_interrupts();

/// The token of which a stop is requested when the user interrupts the program.
[[nodiscard]] std::stop_token interrupt_token();

/// Says what stays where the program is cut off.
void set_interrupt_note(std::string note);

/// The program ends by itself, however long it takes: a server has to store what it acknowledged.
/// Interrupting it is the usual way to end it.
void finish_after_interrupt();

/// Call it last in main(). Ends a program that was interrupted at once (130 for Ctrl-C, 143 for
/// SIGTERM); else, and where that is the usual way to end it, returns `exit_code`.
[[nodiscard]] int end_interrupted_or(int exit_code);

}  // namespace engram::cli
