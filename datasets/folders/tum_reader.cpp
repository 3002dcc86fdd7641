// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/tum_reader.h"

#include <algorithm>
#include <charconv>

#include "ltm/codec/codec.h"
#include "ltm/core/file.h"

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

/// Whether a name of a table stays in its folder.
bool stays_inside(const std::filesystem::path& name) {
  return name.is_relative() && std::ranges::find(name, "..") == name.end();
}

/// Type and shape that a PNG file announces; nothing for kinds that are not read.
std::optional<std::pair<idf::ElementType, idf::Shape>> announced(std::span<const std::byte> file) {
  const auto at = [&](size_t i) { return std::to_integer<int64_t>(file[i]); };
  const auto word = [&](size_t i) {
    return at(i) << 24 | at(i + 1) << 16 | at(i + 2) << 8 | at(i + 3);
  };
  if (file.size() < 26 || at(0) != 0x89 || at(1) != 'P') return std::nullopt;
  const bool is_colour = at(25) == 2;
  if (!is_colour && at(25) != 0) return std::nullopt;
  return std::pair(at(24) == 16 ? idf::ElementType::kUInt16 : idf::ElementType::kUInt8,
                   idf::Shape{word(20), word(16), is_colour ? 3 : 1});
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
  const auto path = folder_ / (name + ".txt");
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
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

std::optional<idf::Data> TumReader::image_of(const std::string& name, bool is_depth) const {
  if (!stays_inside(name)) return std::nullopt;
  const auto file = read_file(folder_ / name);
  const auto found = file.ok() ? announced(file->bytes()) : std::nullopt;
  if (!found || (found->first == idf::ElementType::kUInt16) != is_depth) return std::nullopt;
  auto image = ltm::find_codec("png")->decode(file->bytes(), found->first, found->second);
  if (!image.ok()) return std::nullopt;
  return idf::Dict{{is_depth ? "depth" : "image", *std::move(image)}};
}

std::optional<idf::Data> TumReader::value_of(const Table& table) const {
  const auto& words = table.line->words;
  if (table.content == Content::kImage || table.content == Content::kDepth)
    return image_of(words[0], table.content == Content::kDepth);
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
  if (!shift_) {
    shift_ = start_ ? *start_ - *time : Duration::zero();
    moment.begins = RecordingEpisode{"tum", "", *time + *shift_, {}};
  }
  const Time at = *time + *shift_;
  for (size_t i = 0; i < tables_.size(); ++i) {
    Table& table = tables_[i];
    if (!table.line || table.line->time != *time) continue;
    if (auto value = value_of(table))
      moment.commit.updates.push_back(
          {streams_[i].entity,
           at,
           {{*std::move(value),
             {.created = at, .sent = at, .arrived = at, .provider = "import"}}}});
    else
      ++report_.damaged;
    ENGRAM_RETURN_IF_ERROR(advance(table));
  }
  return std::optional(std::move(moment));
}

}  // namespace engram::datasets
