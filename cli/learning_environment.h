// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::cli {

/// Sets environment variables that OpenMP and the C library read before main(), unless they are
/// already set. Returns whether any was set: a running program must then execute itself again.
///
/// * OpenMP's threads sleep where they wait. By default they spin for milliseconds and starve each
///   other as soon as another process needs a core; so do those that spin for 10 microseconds.
///   Servers and viewers predict, so this is for all commands.
/// * Where the arguments name a command that learns, the memory of tensors stays in the process, in
///   large pages. By default it returns to the system and is mapped again, page by page, with every
///   layer of every step.
///
/// Threading: to be called before other threads start.
/// Source: docs/learning.md, section "Speed".
bool set_learning_environment(int argc, char** argv);

/// Executes the program again if set_learning_environment() has set anything.
void prepare_to_learn(int argc, char** argv);

}  // namespace engram::cli
