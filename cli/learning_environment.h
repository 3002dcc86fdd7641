// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::cli {

/// Whether the arguments name a command that runs networks for a long time.
[[nodiscard]] bool is_learning(int argc, char** argv);

/// Sets environment variables that OpenMP and the C library read before main(), unless they are
/// already set. Returns whether any was set: a running program must then execute itself again.
///
/// * OpenMP's threads sleep where they wait. By default they spin for milliseconds and starve each
///   other as soon as another process needs a core; so do those that spin for 10 microseconds.
/// * The memory of tensors stays in the process, in large pages. By default it returns to the
///   system and is mapped again, page by page, with every layer of every step.
///
/// Threading: to be called before other threads start.
/// Source: docs/learning.md, section "Speed".
bool set_learning_environment();

/// Executes the program again if set_learning_environment() has set anything.
void prepare_to_learn(char** argv);

}  // namespace engram::cli
