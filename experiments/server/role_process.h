// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <string>
#include <vector>

namespace engram::experiments {

/// A process of this program in another role. It prints "ready", reads lines and writes lines.
///
/// Errors: those of starting it and of writing to it end this program.
/// Threading: one thread.
class RoleProcess {
 public:
  /// The file that `shared` becomes in the process.
  static constexpr int kShared = 9;

  /// `words`: its arguments. `shared`: a file that it gets as kShared; negative: none.
  explicit RoleProcess(std::vector<std::string> words, int shared = -1);
  /// Ends it by the end of what it reads, and waits.
  ~RoleProcess();
  RoleProcess(const RoleProcess&) = delete;
  RoleProcess& operator=(const RoleProcess&) = delete;

  void tell(const std::string& line);
  /// The next line that it writes; empty if there is none.
  std::string answer();
  std::string ask(const std::string& line) {
    tell(line);
    return answer();
  }

 private:
  pid_t pid_ = 0;
  int to_ = -1;
  FILE* from_ = nullptr;
};

}  // namespace engram::experiments
