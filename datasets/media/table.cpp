// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <unordered_set>
#include <utility>

#include "datasets/media/csv_reader.h"
#include "ltm/core/ascii.h"

namespace engram::datasets {

namespace {

constexpr std::array<std::string_view, 4> kTimeNames{"timestamp", "time", "t", "stamp"};
constexpr int64_t kMaxExponent = 1'000;

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Quotes a text for a message, and cuts it if it is long.
std::string shown(std::string_view text) {
  constexpr size_t kMaxShown = 40;
  return text.size() <= kMaxShown ? fmt::format("'{}'", text)
                                  : fmt::format("'{}...'", text.substr(0, kMaxShown));
}

std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

template <typename T>
std::optional<T> parse_whole(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// An integer of more than 53 bits may lie between two doubles.
bool is_exact_double(int64_t value) {
  constexpr int64_t kLimit = int64_t{1} << 53;
  return value >= -kLimit && value <= kLimit;
}

/// The parts of a decimal number: sign, digits without leading zeros, and a power of ten.
struct Decimal {
  bool is_negative = false;
  std::string digits;
  int64_t exponent = 0;
};

/// Moves digits from the front of `text` to `digits` and returns their number.
int64_t take_digits(std::string_view& text, std::string& digits) {
  const size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  digits += text.substr(0, count);
  text.remove_prefix(count);
  return static_cast<int64_t>(count);
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal number;
  number.is_negative = text.starts_with('-');
  if (number.is_negative) text.remove_prefix(1);
  int64_t count = take_digits(text, number.digits);
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    const int64_t fraction = take_digits(text, number.digits);
    count += fraction;
    number.exponent = -fraction;
  }
  if (count == 0) return std::nullopt;
  if (text.starts_with('e') || text.starts_with('E')) {
    const auto exponent = parse_whole<int64_t>(without_plus(text.substr(1)));
    if (!exponent || *exponent > kMaxExponent || *exponent < -kMaxExponent) return std::nullopt;
    number.exponent += *exponent;
    text = {};
  }
  if (!text.empty()) return std::nullopt;
  number.digits.erase(0, std::min(number.digits.find_first_not_of('0'), number.digits.size()));
  return number;
}

/// Rounds half away from zero; returns nothing if the result exceeds 64 bits.
std::optional<int64_t> to_integer(Decimal number) {
  std::string& digits = number.digits;
  if (digits.empty()) return 0;
  const auto size = static_cast<int64_t>(digits.size());
  if (size + number.exponent < 0) return 0;
  if (size + number.exponent > 19) return std::nullopt;
  bool rounds_up = false;
  if (number.exponent < 0) {
    const auto kept = static_cast<size_t>(size + number.exponent);
    rounds_up = digits[kept] >= '5';
    digits.resize(kept);
  } else {
    digits.append(static_cast<size_t>(number.exponent), '0');
  }
  const auto whole = digits.empty() ? std::optional<int64_t>(0) : parse_whole<int64_t>(digits);
  int64_t value = 0;
  if (!whole || __builtin_add_overflow(*whole, rounds_up ? 1 : 0, &value)) return std::nullopt;
  return number.is_negative ? -value : value;
}

int64_t exponent_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return 9;
    case TimeUnit::kMilliseconds:
      return 6;
    case TimeUnit::kMicroseconds:
      return 3;
    case TimeUnit::kNanoseconds:
      break;
  }
  return 0;
}

std::string_view name_of(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return "s";
    case TimeUnit::kMilliseconds:
      return "ms";
    case TimeUnit::kMicroseconds:
      return "us";
    case TimeUnit::kNanoseconds:
      break;
  }
  return "ns";
}

/// Splits the name of a column at its dots.
std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  for (size_t dot = name.find('.'); dot != std::string_view::npos; dot = name.find('.')) {
    parts.emplace_back(name.substr(0, dot));
    name.remove_prefix(dot + 1);
  }
  parts.emplace_back(name);
  return parts;
}

}  // namespace

Result<TimeUnit> parse_time_unit(std::string_view text) {
  for (const TimeUnit unit : {TimeUnit::kSeconds, TimeUnit::kMilliseconds, TimeUnit::kMicroseconds,
                              TimeUnit::kNanoseconds})
    if (name_of(unit) == text) return unit;
  return invalid_argument("time unit '{}': needs s, ms, us or ns", text);
}

Result<Duration> parse_decimal_time(std::string_view text, TimeUnit unit) {
  auto number = parse_decimal(without_plus(trimmed(text)));
  if (!number) return invalid_argument("found {}, needs a decimal number", shown(text));
  number->exponent += exponent_of(unit);
  const auto ns = to_integer(*std::move(number));
  if (!ns) return invalid_argument("found {}, needs a time of at most 292 years", shown(text));
  return Duration(*ns);
}

/// Reads the records of one file into a table.
class Table::Builder {
 public:
  Builder(CsvReader reader, const Options& options)
      : reader_(std::move(reader)), options_(options) {}

  Result<Table> build();

 private:
  Status read_header();
  Status find_time(const std::vector<std::string>& names);
  Status add_column(std::string name);
  Status place(size_t column);
  Status add_row(const std::vector<std::string>& cells);
  Status add_time(std::string_view cell);
  Status add_number(TableColumn& column, std::string_view cell) const;
  [[nodiscard]] Status broken(std::string_view what) const;
  [[nodiscard]] Status broken_cell(std::string_view column, std::string_view what) const;

  CsvReader reader_;
  const Options& options_;
  std::string time_name_;
  std::string last_time_text_;
  size_t time_index_ = 0;
  size_t cells_in_row_ = 0;
  std::vector<size_t> cell_of_column_;
  std::unordered_set<std::string> names_;
  Table table_;
};

Status Table::Builder::broken(std::string_view what) const {
  return invalid_argument("table '{}': line {}: {}", reader_.path().string(), reader_.line(), what);
}

Status Table::Builder::broken_cell(std::string_view column, std::string_view what) const {
  return broken(fmt::format("column '{}': {}", column, what));
}

Status Table::Builder::find_time(const std::vector<std::string>& names) {
  if (!options_.time_column.empty()) {
    const auto found = std::ranges::find(names, options_.time_column);
    if (found == names.end())
      return broken(fmt::format("there is no time column '{}'", options_.time_column));
    time_index_ = static_cast<size_t>(found - names.begin());
    return {};
  }
  const auto found = std::ranges::find_if(names, [](const std::string& name) {
    return std::ranges::find(kTimeNames, lower_ascii(name)) != kTimeNames.end();
  });
  if (found == names.end())
    return broken(
        "found no time column, needs one named timestamp, time, t or stamp, or its name as option");
  time_index_ = static_cast<size_t>(found - names.begin());
  return {};
}

/// Inserts a column into the tree of dicts.
Status Table::Builder::place(size_t column) {
  const std::string& name = table_.columns_[column].name;
  const std::vector<std::string> parts = parts_of(name);
  Node* node = &table_.root_;
  for (size_t depth = 0; depth < parts.size(); ++depth) {
    if (parts[depth].empty())
      return broken_cell(name, "found an empty part, needs names between dots");
    const bool is_last = depth + 1 == parts.size();
    const auto child = std::ranges::find(node->children, parts[depth], &Node::key);
    if (child == node->children.end()) {
      node->children.push_back({parts[depth], column, {}});
      node = &node->children.back();
    } else if (is_last || child->children.empty()) {
      return broken_cell(name, fmt::format("contradicts column '{}': the same name would be a "
                                           "number and a dict",
                                           table_.columns_[child->column].name));
    } else {
      node = &*child;
    }
  }
  return {};
}

Status Table::Builder::add_column(std::string name) {
  table_.columns_.push_back({std::move(name), {}});
  return place(table_.columns_.size() - 1);
}

Status Table::Builder::read_header() {
  std::vector<std::string> cells;
  ENGRAM_ASSIGN_OR_RETURN(const bool has_header, reader_.next(cells));
  if (!has_header)
    return invalid_argument("table '{}': is empty, needs a header line", reader_.path().string());
  for (size_t i = 0; i < cells.size(); ++i) {
    cells[i] = std::string(trimmed(cells[i]));
    if (cells[i].empty()) return broken(fmt::format("column {} has no name, needs one", i + 1));
    if (!names_.insert(cells[i]).second)
      return broken_cell(cells[i], "found twice, needs different names");
  }
  // Without this check, the first row of a file that has no header would silently become names.
  if (std::ranges::all_of(cells, [](const std::string& cell) {
        return parse_whole<double>(without_plus(cell)).has_value();
      }))
    return broken("found only numbers, needs a header line with the names of the columns");
  ENGRAM_RETURN_IF_ERROR(find_time(cells));
  time_name_ = cells[time_index_];
  for (const std::string& name : options_.skip_columns)
    if (std::ranges::find(cells, name) == cells.end())
      return broken(fmt::format("there is no column '{}' to leave out", name));
  cells_in_row_ = cells.size();
  for (size_t i = 0; i < cells.size(); ++i) {
    const bool is_skipped =
        std::ranges::find(options_.skip_columns, cells[i]) != options_.skip_columns.end();
    if (i == time_index_ || is_skipped) continue;
    cell_of_column_.push_back(i);
    ENGRAM_RETURN_IF_ERROR(add_column(std::move(cells[i])));
  }
  return {};
}

Status Table::Builder::add_time(std::string_view cell) {
  const auto time = parse_decimal_time(cell, options_.time_unit);
  if (!time.ok()) return broken_cell(time_name_, time.status().message());
  if (!table_.times_.empty() && *time <= table_.times_.back())
    return broken_cell(time_name_,
                       fmt::format("found {} after {}, needs times that increase by a nanosecond "
                                   "or more",
                                   shown(cell), shown(last_time_text_)));
  table_.times_.push_back(*time);
  last_time_text_ = cell;
  return {};
}

Status Table::Builder::add_number(TableColumn& column, std::string_view cell) const {
  const std::string_view text = without_plus(trimmed(cell));
  // Rounding an ID or a counter would change data without notice, so such a number is refused.
  if (const auto whole = parse_whole<int64_t>(text); whole && !is_exact_double(*whole))
    return broken_cell(
        column.name,
        fmt::format("found {}, needs a number that a double holds exactly", shown(cell)));
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc::result_out_of_range)
    return broken_cell(column.name,
                       fmt::format("found {}, needs a number that a double holds", shown(cell)));
  if (error != std::errc() || end != text.data() + text.size())
    return broken_cell(column.name, fmt::format("found {}, needs a number", shown(cell)));
  column.values.push_back(number);
  return {};
}

Status Table::Builder::add_row(const std::vector<std::string>& cells) {
  if (cells.size() != cells_in_row_)
    return broken(
        fmt::format("found {} cells, needs {} as in the header", cells.size(), cells_in_row_));
  ENGRAM_RETURN_IF_ERROR(add_time(cells[time_index_]));
  for (size_t i = 0; i < table_.columns_.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(add_number(table_.columns_[i], cells[cell_of_column_[i]]));
  return {};
}

Result<Table> Table::Builder::build() {
  ENGRAM_RETURN_IF_ERROR(read_header());
  std::vector<std::string> cells;
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_row, reader_.next(cells));
    if (!has_row) break;
    ENGRAM_RETURN_IF_ERROR(add_row(cells));
  }
  if (table_.times_.empty())
    return invalid_argument("table '{}': has a header but no rows, needs one or more",
                            reader_.path().string());
  return std::move(table_);
}

Result<Table> Table::read(const std::filesystem::path& path, const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(CsvReader reader, CsvReader::open(path));
  return Builder(std::move(reader), options).build();
}

idf::Data Table::value_of(const Node& node, size_t row) const {
  if (!node.children.empty()) {
    idf::Dict dict;
    dict.reserve(node.children.size());
    for (const Node& child : node.children) dict.append_unique(child.key, value_of(child, row));
    return dict;
  }
  return columns_[node.column].values[row];
}

idf::Data Table::row_value(size_t row) const {
  ENGRAM_CHECK(row < rows(), "row {} of {}", row, rows());
  return root_.children.empty() ? idf::Data(idf::Dict()) : value_of(root_, row);
}

}  // namespace engram::datasets
