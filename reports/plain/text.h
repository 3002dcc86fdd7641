// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

#include "ltm/memory/source.h"

namespace engram::reports {

/// Such as "1,234,567".
[[nodiscard]] std::string count_text(uint64_t count);

/// Such as "512 B", "1.3 kB", "35.7 MB"; units are powers of 1000.
[[nodiscard]] std::string bytes_text(double bytes);

/// Such as "8 s", "2 min 05 s", "1 h 02 min".
[[nodiscard]] std::string seconds_text(double seconds);

/// Such as "31.84 dB"; "-" for NaN.
[[nodiscard]] std::string db_text(double db);

/// Such as "31.84 dB, RMSE 0.0123", without what is unknown; "-" if both are.
[[nodiscard]] std::string error_text(const ltm::MeasuredError& error);

/// Such as "0.0123"; "-" for NaN.
[[nodiscard]] std::string number_text(double number);

/// A table of text. The first column is aligned to the left, the others to the right. Each cell is
/// one line, whatever is in it.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) { rows_.push_back(std::move(header)); }

  void add(std::vector<std::string> row);
  [[nodiscard]] std::string to_string(std::string_view indent = "") const;

  /// The rows so far. Those that are added later line up with them, if they are no longer.
  [[nodiscard]] std::string take(std::string_view indent = "");

 private:
  [[nodiscard]] std::vector<size_t> widths() const;

  std::vector<std::vector<std::string>> rows_;
  std::vector<size_t> min_widths_;
};

}  // namespace engram::reports
