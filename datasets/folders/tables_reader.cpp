// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tables_reader.h"

#include <cmath>

#include "datasets/folders/folder_image.h"
#include "datasets/folders/later.h"

namespace engram::datasets {

namespace {

Result<idf::Data> member_of(const TableLines& lines, const TableMember& member) {
  std::vector<double> numbers;
  for (const size_t column : member.columns) {
    ENGRAM_ASSIGN_OR_RETURN(const double number, lines.number(column));
    numbers.push_back(number);
  }
  if (!member.is_array) return idf::Data(numbers.front());
  const auto count = static_cast<int64_t>(numbers.size());
  return idf::Data(idf::NdArray::take<double>({count}, std::move(numbers)));
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> TablesReader::create(std::string_view format,
                                                              std::vector<TimedTable> tables,
                                                              ReadingReport met,
                                                              const ReadingOptions& options) {
  std::unique_ptr<TablesReader> reader(new TablesReader(format, options.start));
  reader->report_ = std::move(met);
  for (TimedTable& table : tables) {
    for (const TablePart& part : table.parts) reader->streams_.push_back(part.stream);
    reader->sources_.push_back({std::move(table), std::nullopt, 0});
    ENGRAM_RETURN_IF_ERROR(reader->advance(reader->sources_.back()));
  }
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status TablesReader::advance(Source& source) {
  const auto last = source.time;
  source.time.reset();
  ENGRAM_ASSIGN_OR_RETURN(const bool has_line, source.table.lines.next());
  if (!has_line) return {};
  ENGRAM_ASSIGN_OR_RETURN(Time time, time_of(source));
  ++source.line;
  if (last && time == *last) {
    // The times of one entity must increase, but coarse clocks repeat them.
    time += Duration(1);
    ++report_.not_carried["repeated times, moved by 1 ns"];
  }
  if (last && time <= *last)
    return source.table.lines.broken(
        *source.table.time_column,
        fmt::format("needs a time behind that of the line before, {}", to_string(*last)));
  source.time = time;
  return {};
}

Result<Time> TablesReader::time_of(const Source& source) const {
  const TimedTable& table = source.table;
  if (table.time_column) return table.lines.time(*table.time_column, table.unit);
  const double ns = static_cast<double>(source.line) * (1e9 / table.rate_hz);
  if (!(ns < 9.2e18))
    return invalid_argument("'{}': at {} Hz line {} is behind the year 2261",
                            table.lines.path().string(), table.rate_hz, source.line + 1);
  return Time(Duration(std::llround(ns)));
}

/// Shifts a time so that the first moment is at the requested start.
Result<Time> TablesReader::shifted(Time time) const {
  if (!start_) return time;
  int64_t since = 0;
  if (__builtin_sub_overflow(to_ns(time), to_ns(*first_), &since)) since = INT64_MAX;
  return later(*start_, Duration(since));
}

Result<std::optional<RecordingReader::Moment>> TablesReader::next() {
  std::optional<Time> time;
  for (const Source& source : sources_)
    if (source.time && (!time || *source.time < *time)) time = source.time;
  if (!time) return std::optional<Moment>();
  Moment moment;
  const bool is_first = !first_;
  if (is_first) first_ = time;
  ENGRAM_ASSIGN_OR_RETURN(const Time at, shifted(*time));
  if (is_first) moment.begins = RecordingEpisode{format_, "", at, {}};
  for (Source& source : sources_) {
    if (source.time != time) continue;
    ENGRAM_RETURN_IF_ERROR(add(source, at, moment.commit));
    ENGRAM_RETURN_IF_ERROR(advance(source));
  }
  return std::optional(std::move(moment));
}

Status TablesReader::add(Source& source, Time at, ltm::Commit& commit) {
  for (const TablePart& part : source.table.parts) {
    ENGRAM_ASSIGN_OR_RETURN(auto value, value_of(source, part));
    if (value)
      commit.updates.push_back(imported(part.stream.entity, at, *std::move(value)));
    else
      ++report_.damaged;
  }
  return {};
}

Result<std::optional<idf::Data>> TablesReader::value_of(const Source& source,
                                                        const TablePart& part) const {
  const TimedTable& table = source.table;
  if (part.kind != TablePart::Kind::kNumbers)
    // Nothing for an image that is missing or broken: it is counted, and the import goes on.
    return folder_image(table.images,
                        table.file_column
                            ? std::filesystem::path(table.lines.cell(*table.file_column))
                            : table.files.at(source.line - 1),
                        part.kind == TablePart::Kind::kDepth);
  idf::Dict value;
  for (const TableMember& member : part.members) {
    ENGRAM_ASSIGN_OR_RETURN(auto data, member_of(table.lines, member));
    value.set(member.name, std::move(data));
  }
  return std::optional<idf::Data>(std::move(value));
}

}  // namespace engram::datasets
