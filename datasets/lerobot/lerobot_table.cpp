// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_table.h"

#include <stdlib.h>

#include <algorithm>
#include <charconv>
#include <fstream>

#include "datasets/lerobot/parquet_script.h"
#include "datasets/media/table.h"
#include "datasets/recordings/folder_file.h"
#include "ltm/core/line_process.h"

namespace engram::datasets::lerobot {

namespace {

constexpr auto kPatience = std::chrono::minutes(10);
constexpr Duration kMaxSeconds = std::chrono::seconds(100'000'000);
constexpr size_t kMaxTextShown = 40;

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

template <typename Value>
std::optional<Value> parsed(std::string_view text) {
  Value value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Status convert(const std::filesystem::path& parquet, const std::filesystem::path& script,
               const std::filesystem::path& csv) {
  const char* named = ::getenv("ENGRAM_PYTHON");
  const std::string python = named != nullptr && *named != '\0' ? named : "python3";
  if (!(std::ofstream(script) << parquet_script()).flush())
    return unavailable("'{}' cannot be written", script.string());
  LineProcess process;
  ENGRAM_RETURN_IF_ERROR(process.start({python, script.string(), parquet.string(), csv.string()}));
  while (true) {
    auto line = process.read_line(kPatience);
    if (!line.ok())
      return line.status().with_context(fmt::format("'{}' through pyarrow", parquet.string()));
    // Python prints warnings of its own, so other lines are ignored.
    if (*line == "engram: done") return {};
    if (*line == "engram: no pyarrow")
      return failed_precondition(
          "'{}': {} has no pyarrow to read it (pip install pyarrow; ENGRAM_PYTHON names another "
          "Python); a table '{}' beside it does as well",
          parquet.string(), python, parquet.stem().string() + ".csv");
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  std::string name =
      (std::filesystem::temp_directory_path(error) / "engram-lerobot-XXXXXX").string();
  if (!error && ::mkdtemp(name.data()) != nullptr) path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path csv_of(const std::filesystem::path& root,
                             const std::filesystem::path& parquet, bool looks_in_tables) {
  std::filesystem::path beside = parquet;
  beside.replace_extension(".csv");
  std::error_code error;
  if (std::filesystem::is_regular_file(root / beside, error)) return beside;
  const auto in_tables = std::filesystem::path("tables") / beside.filename();
  if (looks_in_tables && std::filesystem::is_regular_file(root / in_tables, error))
    return in_tables;
  return {};
}

Result<RowTable> RowTable::open(const std::filesystem::path& root,
                                const std::filesystem::path& parquet, bool looks_in_tables) {
  if (const auto csv = csv_of(root, parquet, looks_in_tables); !csv.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(root, csv));
    return open_csv(root, path);
  }
  const auto path = file_in_folder(root, parquet);
  if (path.status().code() == StatusCode::kNotFound)
    return not_found("{}, and no CSV beside it", path.status().message());
  if (!path.ok()) return path.status();
  auto folder = std::make_unique<TemporaryFolder>();
  if (folder->path().empty()) return unavailable("no temporary folder can be made");
  const std::filesystem::path csv = folder->path() / "table.csv";
  ENGRAM_RETURN_IF_ERROR(convert(*path, folder->path() / "parquet_to_csv.py", csv));
  ENGRAM_ASSIGN_OR_RETURN(RowTable table, create(folder->path(), path->string(), csv));
  table.folder_ = std::move(folder);
  return table;
}

Result<RowTable> RowTable::open_csv(const std::filesystem::path& root,
                                    const std::filesystem::path& csv) {
  return create(root, csv.string(), csv);
}

Result<RowTable> RowTable::create(std::filesystem::path root, std::string title,
                                  const std::filesystem::path& csv) {
  ENGRAM_ASSIGN_OR_RETURN(CsvReader reader, CsvReader::open(csv));
  RowTable table(std::move(root), std::move(title), std::move(reader));
  ENGRAM_ASSIGN_OR_RETURN(const bool has_header, table.csv_.next(table.names_));
  if (!has_header)
    return invalid_argument("'{}': is empty, needs a line with the names of its columns",
                            table.title_);
  for (size_t i = 0; i < table.names_.size(); ++i) {
    table.names_[i] = trimmed(table.names_[i]);
    table.columns_.try_emplace(table.names_[i], i);
  }
  return table;
}

std::optional<size_t> RowTable::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    if (const auto found = columns_.find(name); found != columns_.end()) return found->second;
  return std::nullopt;
}

Result<size_t> RowTable::need(const std::string& name) const {
  if (const auto found = find({name})) return *found;
  return invalid_argument("'{}': found {} columns, needs one called '{}'", title_, names_.size(),
                          name);
}

Result<bool> RowTable::next() {
  ENGRAM_ASSIGN_OR_RETURN(const bool has_row, csv_.next(cells_));
  if (!has_row) return false;
  ++row_;
  if (cells_.size() != names_.size())
    return invalid_argument("'{}': row {} has {} cells, needs {} as the header", title_, row_,
                            cells_.size(), names_.size());
  return true;
}

Result<std::optional<double>> RowTable::number(size_t column) const {
  std::string_view text = trimmed(cells_[column]);
  if (text.empty()) return std::optional<double>();
  // Flags such as next.done are numbers in Parquet, and words in CSV files that pandas wrote.
  if (text == "True" || text == "true") return std::optional(1.0);
  if (text == "False" || text == "false") return std::optional(0.0);
  if (text.starts_with('+')) text.remove_prefix(1);
  if (const auto value = parsed<double>(text)) return value;
  return broken(column, "needs a number");
}

Result<std::optional<int64_t>> RowTable::integer(size_t column) const {
  std::string_view text = trimmed(cells_[column]);
  if (text.empty()) return std::optional<int64_t>();
  if (text == "True" || text == "true") return std::optional<int64_t>(1);
  if (text == "False" || text == "false") return std::optional<int64_t>(0);
  // Whole numbers have this ending in tables in which some cells of the column are empty.
  if (text.ends_with(".0")) text.remove_suffix(2);
  if (const auto value = parsed<int64_t>(text)) return value;
  return broken(column, "needs a whole number");
}

Result<int64_t> RowTable::whole(size_t column) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto value, integer(column));
  if (value && *value >= 0) return *value;
  return broken(column, "needs a whole number of 0 or more");
}

Result<Duration> RowTable::seconds(size_t column) const {
  const auto time = parse_decimal_time(cells_[column], TimeUnit::kSeconds);
  if (time.ok() && *time >= Duration::zero() && *time <= kMaxSeconds) return *time;
  return broken(column, "needs seconds from 0 to 1e8");
}

Result<std::filesystem::path> RowTable::file(size_t column) const {
  auto path = file_in_folder(root_, cells_[column]);
  if (path.ok()) return path;
  return path.status().with_context(
      fmt::format("'{}': row {}, column '{}'", title_, row_, names_[column]));
}

Status RowTable::broken(size_t column, std::string_view what) const {
  const std::string& cell = cells_[column];
  return invalid_argument(
      "'{}': row {}, column '{}': found '{}', {}", title_, row_, names_[column],
      cell.size() > kMaxTextShown ? cell.substr(0, kMaxTextShown) + "..." : cell, what);
}

}  // namespace engram::datasets::lerobot
