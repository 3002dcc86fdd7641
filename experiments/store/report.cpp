// SPDX-License-Identifier: Apache-2.0
#include "store/report.h"

#include <algorithm>
#include <cstdio>

#include "ltm/core/check.h"
#include "ltm/core/file.h"

namespace engram::experiments {

void TextTable::add(std::vector<std::string> cells) {
  ENGRAM_CHECK(cells.size() == rows_.front().size(), "{} cells", cells.size());
  rows_.push_back(std::move(cells));
}

std::string TextTable::to_string() const {
  std::vector<size_t> widths(rows_.front().size());
  for (const auto& row : rows_)
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (size_t r = 0; r < rows_.size(); ++r) {
    for (size_t i = 0; i < widths.size(); ++i)
      text += fmt::format("| {:<{}} ", rows_[r][i], widths[i]);
    text += "|\n";
    if (r != 0) continue;
    for (const size_t width : widths) text += fmt::format("|{:-<{}}", "", width + 2);
    text += "|\n";
  }
  return text;
}

nlohmann::json to_json(const Latency& latency) {
  return {{"median_ms", 1e3 * latency.median},
          {"p99_ms", 1e3 * latency.p99},
          {"max_ms", 1e3 * latency.max}};
}

Status write_json(const std::filesystem::path& path, const nlohmann::json& value) {
  if (path.empty()) return {};
  return replace_file(std::filesystem::absolute(path), as_bytes(value.dump(2) + "\n"));
}

std::string verdict(bool is_met) {
  return is_met ? "ok" : "missed";
}

int exit_code(std::string_view program, const Status& status) {
  if (status.ok()) return 0;
  fmt::print(stderr, "{}: {}\n", program, status.to_string());
  return 1;
}

}  // namespace engram::experiments
