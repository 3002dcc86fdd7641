// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <functional>
#include <vector>

#include "tests/faults/session.h"

namespace engram::ltm::faults {

/// How a process ended.
struct Outcome {
  int exit_code = -1;
  int signal = 0;  ///< That ended it; 0 where none did.

  [[nodiscard]] bool is_clean() const { return signal == 0 && exit_code == 0; }
};

/// Runs `work` in a process of its own. It ends with _exit(0): nothing is closed or flushed.
Outcome run_child(const std::function<void()>& work);

/// Lets a session tell into a file, at its end.
[[nodiscard]] Tell tell_into(const std::filesystem::path& file);

[[nodiscard]] std::vector<Told> read_told(const std::filesystem::path& file);

/// What a session told in the bytes of such a file.
[[nodiscard]] std::vector<Told> told_of(std::string_view bytes);

/// Every n-th of many cases: 1 where the environment has ENGRAM_FAULTS_ALL, else `stride`.
[[nodiscard]] size_t stride_or_all(size_t stride);

}  // namespace engram::ltm::faults
