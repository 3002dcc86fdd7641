// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "store/store_measure.h"

namespace engram::experiments {

/// A Markdown table whose columns are padded to the width of their cells.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> head) : rows_{std::move(head)} {}

  /// There must be as many cells as the head has (checked).
  void add(std::vector<std::string> cells);

  [[nodiscard]] std::string to_string() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Returns {"median_ms", "p99_ms", "max_ms"}.
[[nodiscard]] nlohmann::json to_json(const Latency& latency);

/// Writes an indented file; does nothing if the path is empty.
Status write_json(const std::filesystem::path& path, const nlohmann::json& value);

/// Returns "ok" or "missed", which tells in a table whether a bar was met.
[[nodiscard]] std::string verdict(bool is_met);

/// Returns the exit code of a program: 0, or 1 after printing the error.
[[nodiscard]] int exit_code(std::string_view program, const Status& status);

}  // namespace engram::experiments
