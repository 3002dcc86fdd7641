// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace engram::soak {

/// Numbers that one process writes down, one by one, and another reads when it was killed.
///
/// Threading: thread-safe.
class Ledger {
 public:
  explicit Ledger(const std::filesystem::path& file);
  ~Ledger();
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  void write(int64_t number) const;

  /// All that was ever written; empty where there is no such file.
  static std::vector<int64_t> read(const std::filesystem::path& file);

 private:
  int file_;
};

}  // namespace engram::soak
