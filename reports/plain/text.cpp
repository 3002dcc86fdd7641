// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/text.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ltm/core/printable.h"
#include "training/quality/psnr.h"

namespace engram::reports {

std::string count_text(uint64_t count) {
  std::string digits = std::to_string(count);
  for (size_t at = digits.size(); at > 3;) digits.insert(at -= 3, ",");
  return digits;
}

std::string bytes_text(double bytes) {
  static constexpr std::array kUnits{"B", "kB", "MB", "GB", "TB", "PB"};
  size_t unit = 0;
  while (std::abs(bytes) >= 999.5 && unit + 1 < kUnits.size()) {
    bytes /= 1000;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", bytes, unit == 0 || bytes >= 99.95 ? 0 : 1, kUnits[unit]);
}

std::string seconds_text(double seconds) {
  const auto whole = static_cast<int64_t>(std::llround(std::max(0.0, seconds)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string db_text(double db) {
  return std::isnan(db) ? "-" : fmt::format("{:.2f} dB", db);
}

std::string number_text(double number) {
  return std::isnan(number) ? "-" : fmt::format("{:.4g}", number);
}

std::string error_text(const ltm::MeasuredError& error) {
  std::string text;
  if (!std::isnan(error.image_mse)) text = db_text(training::psnr_db(error.image_mse));
  if (!std::isnan(error.number_mse))
    text += (text.empty() ? "" : ", ") + ("RMSE " + number_text(std::sqrt(error.number_mse)));
  return text.empty() ? "-" : text;
}

void TextTable::add(std::vector<std::string> row) {
  for (std::string& cell : row) cell = printable(cell);
  rows_.push_back(std::move(row));
}

std::vector<size_t> TextTable::widths() const {
  std::vector<size_t> widths = min_widths_;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

std::string TextTable::take(std::string_view indent) {
  std::string text = to_string(indent);
  min_widths_ = widths();
  rows_.clear();
  return text;
}

std::string TextTable::to_string(std::string_view indent) const {
  const std::vector<size_t> widths = this->widths();
  std::string text;
  for (const auto& row : rows_) {
    std::string line(indent);
    for (size_t i = 0; i < row.size(); ++i)
      line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i])
                     : fmt::format("  {:>{}}", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace engram::reports
