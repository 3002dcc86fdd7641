// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "ltm/core/file.h"

namespace engram::ltm {

/// Keeps jobs that learn from a store and those that erase from it apart: what a model learned
/// before something was erased must not be published afterwards. Its file is `NIGHT.lock`.
///
/// Owns: the lock, until it or its process ends. Threading: one thread.
class NightLock {
 public:
  /// For a job that learns. Any number of them may run at the same time.
  /// Errors: kFailedPrecondition if a process erases from the store; kUnavailable; those of
  /// read_manifest.
  static Result<NightLock> of_learning(const std::filesystem::path& store);

  /// For a job that erases. It runs alone.
  /// Errors: kFailedPrecondition if a process learns from the store or erases from it; those above.
  static Result<NightLock> of_erasing(const std::filesystem::path& store);

 private:
  explicit NightLock(File file) : file_(std::move(file)) {}
  static Result<NightLock> take(const std::filesystem::path& store, File::LockKind kind,
                                std::string_view others);

  File file_;
};

}  // namespace engram::ltm
