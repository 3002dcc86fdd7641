// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "speech/learning/dialogue_examples.h"

namespace engram::speech {

/// More than any confidence: nothing is told.
inline constexpr double kNeverSure = 2;

/// How a network learns to read questions.
struct LearnOptions {
  /// Zero with `start`: only the limits of that network are measured anew.
  Duration budget = std::chrono::minutes(60);
  int threads = 1;
  int64_t batch = 48;
  double learning_rate = 1e-3;
  uint64_t seed = 1;
  /// A network whose weights it starts from; empty: it starts anew.
  std::filesystem::path start{};
  /// Called between steps, and may wait, as while the robot is busy: that is no time of learning.
  std::function<Status()> pause{};
  /// So much of what is told of held-out questions is right, and so many of those that cannot be
  /// answered are refused: min_confidence follows from both, by wordings that are held out, as
  /// people ask in their own.
  double min_right = 0.9;
  double min_refused = 0.95;
  /// The same of what counts more than rules of the grammar.
  double sure_right = 0.95;

  [[nodiscard]] Status validate() const;
};

struct LearnReport {
  size_t examples = 0;
  size_t held_out = 0;
  int64_t steps = 0;
  int64_t parameters = 0;
  double seconds = 0;
  double loss = 0;  ///< The mean of the last hundred steps.
  /// The share of the held-out questions that are read as the very program, or rightly as none, and
  /// that of those whose wording is held out.
  double read_rightly = 0;
  double new_wordings_read_rightly = 0;
  /// The share that is told from min_confidence on, and how much of that is right.
  double told = 0;
  double told_rightly = 0;
  /// The share of what cannot be answered that is refused below min_confidence.
  double refused = 0;
  double min_confidence = kNeverSure;
  double sure_confidence = kNeverSure;
};

/// Trains a network of the route of attention and writes it to `file`. Examples that are held out
/// take no part in training; the limits of confidence are measured on those with a trial.
/// Errors: kInvalidArgument if there are fewer than 100 examples, or options do not validate; those
/// of load_attention for `start`; kCancelled; kUnavailable. Where it ends early, `file` is as it
/// was, and "<file>.unfinished" has what was learned, from which the next lesson with this file
/// goes on. Threading: one thread that calls; `threads` that compute.
Result<LearnReport> learn_to_answer(const std::vector<AttentionExample>& examples,
                                    const LearnOptions& options, const std::filesystem::path& file,
                                    const ProgressSink& progress, const std::stop_token& stop);

/// What is learned of, and where it goes.
struct Lesson {
  std::vector<std::filesystem::path> stores;
  ExampleOptions examples{.dialogues = {.count = 1500, .careless = 0.15}};
  LearnOptions options;
  std::filesystem::path file;
  std::optional<Time> until{};  ///< When it is over, whatever the budget is.
};

struct LessonReport {
  ExampleCounts dialogues;
  LearnReport learned;
};

/// Makes dialogues of stores, which are opened for reading alone, and learns from them.
/// Errors: those of Memory::open, add_examples and learn_to_answer; kResourceExhausted if no time
/// is left once the dialogues are made.
Result<LessonReport> learn_from(const Lesson& lesson, const ProgressSink& progress,
                                const std::stop_token& stop);

}  // namespace engram::speech
