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

/// A table in the way of Markdown, its columns as wide as their cells.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> head) : rows_{std::move(head)} {}

  /// Needs as many cells as the head has (checked).
  void add(std::vector<std::string> cells);

  [[nodiscard]] std::string to_string() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// {"median_ms", "p99_ms", "max_ms"}.
[[nodiscard]] nlohmann::json to_json(const Latency& latency);

/// Writes an indented file; nothing where the path is empty.
Status write_json(const std::filesystem::path& path, const nlohmann::json& value);

/// "ok" or "missed": whether a bar was met, in a table.
[[nodiscard]] std::string verdict(bool is_met);

/// What a program returns: 0, or 1 after it said what went wrong.
[[nodiscard]] int exit_code(std::string_view program, const Status& status);

}  // namespace engram::experiments
