// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace engram::soak {

/// A process of this program in another role, which is started again and again.
///
/// Threading: one thread.
class Process {
 public:
  /// `words`: what it is told; it gets the number of the start behind them.
  explicit Process(std::vector<std::string> words) : words_(std::move(words)) {}
  /// Kills it.
  ~Process();
  Process(Process&& other) noexcept;

  void start();
  /// Without a word (SIGKILL), and waits for its end.
  void kill();
  /// Tells it to end, and waits; false where it had to be killed after a while, or failed.
  bool end();

  /// Ended by itself, which it should not.
  [[nodiscard]] bool has_ended();

  /// What it has in RAM now.
  [[nodiscard]] size_t resident_bytes() const;

  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }

 private:
  std::vector<std::string> words_;
  int starts_ = 0;
  pid_t pid_ = -1;
};

}  // namespace engram::soak
