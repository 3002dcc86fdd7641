// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace engram::cli {

/// Whether the arguments name a command that runs networks for long.
[[nodiscard]] bool is_learning(int argc, char** argv);

/// Sets what OpenMP and the C library read before main(), as far as the environment does not say it
/// already. Returns whether something was set: a program that runs already has to start over.
///
/// * OpenMP's threads spin only shortly where they wait. By default they spin for milliseconds and
///   starve each other as soon as another process wants a core; sleeping at once costs as much on
///   an idle machine.
/// * Memory of tensors stays in the process, in large pages. By default each goes back to the
///   system and comes anew, page by page, with every layer of every step.
///
/// Threading: before other threads begin.
/// Source: docs/learning.md, section "Speed".
bool set_learning_environment();

/// Starts the program over where that set something.
void prepare_to_learn(char** argv);

}  // namespace engram::cli
