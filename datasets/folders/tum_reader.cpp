// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tum_reader.h"

#include <charconv>

#include "datasets/folders/folder_image.h"
#include "datasets/recordings/folder_file.h"

namespace engram::datasets {

namespace {

constexpr double kDepthPerMetre = 5000;

std::optional<std::vector<double>> numbers_of(const std::vector<std::string>& words) {
  std::vector<double> values;
  for (const std::string& word : words) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    values.push_back(value);
  }
  return values;
}

}  // namespace

Result<std::unique_ptr<RecordingReader>> TumReader::open(const std::filesystem::path& folder,
                                                         const ReadingOptions& options) {
  std::unique_ptr<TumReader> reader(new TumReader(folder));
  reader->start_ = options.start;
  ENGRAM_RETURN_IF_ERROR(reader->add_table("rgb", Content::kImage, 1, "Vision/RGB", options));
  ENGRAM_RETURN_IF_ERROR(reader->add_table("depth", Content::kDepth, 1, "Vision/Depth", options));
  ENGRAM_RETURN_IF_ERROR(
      reader->add_table("groundtruth", Content::kPose, 7, "RobotState/Localization", options));
  ENGRAM_RETURN_IF_ERROR(reader->add_table("accelerometer", Content::kNumbers, 3,
                                           "RobotState/Proprioception", options));
  if (reader->tables_.empty())
    return invalid_argument("'{}': has none of rgb.txt, depth.txt, groundtruth.txt",
                            folder.string());
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

Status TumReader::add_table(const std::string& name, Content content, size_t words,
                            std::string_view segment, const ReadingOptions& options) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder_ / (name + ".txt"), ignored)) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(folder_, name + ".txt"));
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId entity, ltm::MemoryId::parse(segment));
  ENGRAM_ASSIGN_OR_RETURN(entity, entity.child(options.provider));
  ENGRAM_ASSIGN_OR_RETURN(entity, entity.child(name));
  ENGRAM_ASSIGN_OR_RETURN(ListedLines lines, ListedLines::open(path, words));
  idf::Dict attributes;
  if (content == Content::kDepth) attributes.set("per_metre", kDepthPerMetre);
  streams_.push_back({entity, name, 0, std::move(attributes)});
  tables_.push_back({std::move(lines), content, std::nullopt, std::nullopt});
  return advance(tables_.back());
}

Status TumReader::advance(Table& table) {
  ENGRAM_ASSIGN_OR_RETURN(table.line, table.lines.next());
  if (!table.line) return {};
  if (table.last && table.line->time == *table.last) {
    table.line->time += Duration(1);
    ++report_.not_carried["repeated times, moved by 1 ns"];
  }
  if (table.last && table.line->time <= *table.last)
    return invalid_argument("'{}': line {} is of {}, needs to come after {}",
                            table.lines.path().string(), table.line->number,
                            to_string(table.line->time), to_string(*table.last));
  table.last = table.line->time;
  return {};
}

std::optional<idf::Data> TumReader::value_of(const Table& table) const {
  const auto& words = table.line->words;
  if (table.content == Content::kImage || table.content == Content::kDepth)
    return folder_image(folder_, words[0], table.content == Content::kDepth);
  const auto numbers = numbers_of(words);
  if (!numbers) return std::nullopt;
  const auto& n = *numbers;
  if (table.content == Content::kNumbers)
    return idf::Dict{{"values", idf::NdArray::take<double>({3}, {n[0], n[1], n[2]})}};
  return idf::Dict{{"position", idf::NdArray::take<double>({3}, {n[0], n[1], n[2]})},
                   {"orientation", idf::NdArray::take<double>({4}, {n[6], n[3], n[4], n[5]})}};
}

Result<std::optional<RecordingReader::Moment>> TumReader::next() {
  std::optional<Time> time;
  for (const Table& table : tables_)
    if (table.line && (!time || table.line->time < *time)) time = table.line->time;
  if (!time) return std::optional<Moment>();
  Moment moment;
  const bool is_first = !first_;
  if (is_first) first_ = time;
  ENGRAM_ASSIGN_OR_RETURN(const Time at, start_ ? later(*start_, *time - *first_) : *time);
  if (is_first) moment.begins = RecordingEpisode{"tum", "", at, {}};
  for (size_t i = 0; i < tables_.size(); ++i) {
    Table& table = tables_[i];
    if (!table.line || table.line->time != *time) continue;
    if (auto value = value_of(table))
      moment.commit.updates.push_back(imported(streams_[i].entity, at, *std::move(value)));
    else
      ++report_.damaged;
    ENGRAM_RETURN_IF_ERROR(advance(table));
  }
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets
