// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/table_lines.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>
#include <utility>

#include "datasets/recordings/read_image_file.h"

namespace engram::datasets {

namespace {

constexpr size_t kMaxLineBytes = size_t{1} << 16;
constexpr size_t kMaxColumns = 10'000;
constexpr size_t kMaxShown = 40;

std::string trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::optional<double> number_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Returns true if the cells of the first line are names of columns.
bool are_names(const std::vector<std::string>& cells) {
  return std::ranges::any_of(cells, [](const std::string& cell) {
    return !cell.empty() && !is_number(cell) && !has_image_name(cell);
  });
}

/// Returns true if the first line that is not empty has a comma.
bool has_commas(std::ifstream& file) {
  std::array<char, kMaxLineBytes> line{};
  while (file.getline(line.data(), line.size()))
    if (!trimmed(line.data()).empty())
      return std::string_view(line.data()).find(',') != std::string_view::npos;
  return false;
}

}  // namespace

bool is_number(std::string_view text) {
  return number_of(text).has_value();
}

Result<TableLines> TableLines::open_words(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return not_found("'{}': there is no such file", path.string());
  if (!std::filesystem::is_regular_file(path, error))
    return invalid_argument("'{}': is no file", path.string());
  std::ifstream words(path, std::ios::binary);
  if (!words) return unavailable("'{}': cannot be opened", path.string());
  return TableLines(path, std::move(words));
}

Result<TableLines> TableLines::open(const std::filesystem::path& path,
                                    std::vector<std::string> names) {
  ENGRAM_ASSIGN_OR_RETURN(TableLines lines, open_words(path));
  lines.names_ = std::move(names);
  lines.has_names_ = lines.is_known_ = true;
  return lines;
}

Result<TableLines> TableLines::open(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(TableLines lines, open_words(path));
  if (has_commas(lines.words_)) {
    ENGRAM_ASSIGN_OR_RETURN(lines.csv_, CsvReader::open(path));
  }
  lines.words_.clear();
  lines.words_.seekg(0);
  ENGRAM_ASSIGN_OR_RETURN(const bool has_line, lines.next_cells());
  if (!has_line)
    return invalid_argument("'{}': is empty, needs a line for each image", path.string());
  if (lines.cells_.size() > kMaxColumns)
    return invalid_argument("'{}': has {} columns, needs at most {}", path.string(),
                            lines.cells_.size(), kMaxColumns);
  lines.has_names_ = are_names(lines.cells_);
  // A first line without names is already a row, so next() must return it once.
  lines.has_first_ = !lines.has_names_;
  for (size_t i = 0; i < lines.cells_.size(); ++i)
    lines.names_.push_back(lines.has_names_ ? lines.cells_[i] : fmt::format("column {}", i + 1));
  if (lines.has_names_ && lines.names_.front().starts_with('#'))
    lines.names_.front() = trimmed(lines.names_.front().substr(1));
  return lines;
}

Result<bool> TableLines::next() {
  if (std::exchange(has_first_, false)) return true;
  ENGRAM_ASSIGN_OR_RETURN(const bool has_line, next_cells());
  if (has_line && cells_.size() != names_.size())
    return invalid_argument(
        "'{}': line {} has {} cells, needs {}{}", path_.string(), line(), cells_.size(),
        names_.size(),
        is_known_ ? fmt::format(": {}", fmt::join(names_, " ")) : " as the first line");
  return has_line;
}

Result<bool> TableLines::next_cells() {
  if (!csv_) return next_words();
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_line, csv_->next(cells_));
    if (!has_line) return false;
    for (std::string& cell : cells_) cell = trimmed(cell);
    // Lines with '#' are comments, except for the names in the first line.
    if (names_.empty() || !cells_.front().starts_with('#')) return true;
  }
}

Result<bool> TableLines::next_words() {
  std::array<char, kMaxLineBytes> buffer{};
  while (words_.getline(buffer.data(), buffer.size())) {
    ++line_;
    std::istringstream text(buffer.data());
    cells_.clear();
    for (std::string word; text >> word;) cells_.push_back(std::move(word));
    if (cells_.empty() || (!names_.empty() && cells_.front().starts_with('#'))) continue;
    // The line is "# timestamp filename".
    if (cells_.front() == "#") cells_.erase(cells_.begin());
    if (!cells_.empty()) return true;
  }
  if (words_.eof()) return false;
  return invalid_argument("'{}': line {} has more than {} bytes", path_.string(), line_ + 1,
                          kMaxLineBytes - 1);
}

Result<double> TableLines::number(size_t column) const {
  if (const auto value = number_of(cells_[column])) return *value;
  return broken(column, "needs a number");
}

Result<Time> TableLines::time(size_t column, TimeUnit unit) const {
  const auto since_epoch = parse_decimal_time(cells_[column], unit);
  if (!since_epoch.ok()) return broken(column, "needs a time of at most 292 years");
  return Time(*since_epoch);
}

Status TableLines::broken(size_t column, std::string_view what) const {
  const std::string& cell = cells_[column];
  return invalid_argument("'{}': line {}, column '{}': found '{}', {}", path_.string(), line(),
                          names_[column],
                          cell.size() > kMaxShown ? cell.substr(0, kMaxShown) + "..." : cell, what);
}

}  // namespace engram::datasets
