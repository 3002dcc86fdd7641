// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram {

/// The file descriptors of a child.
struct ChildStreams {
  std::optional<int> output{};  ///< It writes there; empty: where its parent does.
  std::optional<int> errors{};
  std::optional<int> input{};  ///< It reads from there; empty: there is nothing to read.
};

/// When a child ends, if not by itself.
enum class ChildLife : uint8_t {
  kItsOwn,
  /// The kernel kills it when the *thread* that started it ends, even if that is killed. So that
  /// thread must live as long as the child.
  kWithThread,
};

/// Starts a program as a child in a process group of its own, with no signal blocked or ignored and
/// with no other file of its parent. `words` is the program, which is searched on the path, and its
/// arguments; not empty. The caller must wait for the child (waitpid).
/// Errors: kNotFound where there is no such program; kUnavailable with the system's reason.
Result<pid_t> start_child(const std::vector<std::string>& words, const ChildStreams& streams,
                          ChildLife life = ChildLife::kItsOwn);

}  // namespace engram
