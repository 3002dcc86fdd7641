// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: tables of one line per moment.

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"

namespace engram::datasets {

/// "1305031102.175304" as a moment, exactly: seconds since the epoch with up to nine digits.
[[nodiscard]] std::optional<Time> time_from_decimal(std::string_view text);

/// `time` and so much more.
/// Errors: kInvalidArgument behind the year 2262.
Result<Time> later(Time time, Duration more);

/// Reads lines of a time and words behind it. Lines that are empty or begin with '#' are left out.
///
/// Errors: kInvalidArgument naming file, line, what was found and what was needed. Memory: one
/// line. Threading: one thread.
class ListedLines {
 public:
  /// Each line needs `words` words behind the time. Errors: kNotFound.
  static Result<ListedLines> open(const std::filesystem::path& path, size_t words);

  struct Line {
    Time time{};
    std::vector<std::string> words;
    uint64_t number = 0;  ///< In the file, from 1.
  };
  /// Nothing behind the last one.
  Result<std::optional<Line>> next();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  ListedLines(std::filesystem::path path, std::ifstream file, size_t words)
      : path_(std::move(path)), file_(std::move(file)), words_(words) {}

  std::filesystem::path path_;
  std::ifstream file_;
  size_t words_;
  uint64_t number_ = 0;
};

}  // namespace engram::datasets
