// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/images_folder.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <tuple>

#include "datasets/recordings/folder_file.h"
#include "datasets/recordings/read_image_file.h"

namespace engram::datasets {

namespace {

constexpr const char* kSayRate = "or say --format images --value-rate 30";
// Whole numbers from here on must be nanoseconds: in a coarser unit they would exceed 64 bits.
constexpr double kOnlyNanoseconds = 9.3e15;

bool has_table_name(const std::filesystem::path& path) {
  return path.extension() == ".csv" || path.extension() == ".txt";
}

/// Orders names by the numbers in them: "9.png" before "10.png".
bool comes_before(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& name) {
    const size_t digit = std::min(name.find_first_of("0123456789"), name.size());
    const size_t first = std::min(name.find_first_not_of('0', digit), name.size());
    const size_t end = std::min(name.find_first_not_of("0123456789", first), name.size());
    return std::tuple(name.substr(0, digit), end - first, name.substr(first, end - first), name);
  };
  return key(a) < key(b);
}

std::vector<std::string> image_names(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (has_image_name(entry.path())) names.push_back(entry.path().filename().string());
  std::ranges::sort(names, comes_before);
  return names;
}

bool has_images(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::directory_iterator entries(folder, error);
  return !error && std::ranges::any_of(
                       entries, [](const auto& entry) { return has_image_name(entry.path()); });
}

/// The contents of a folder.
struct Found {
  std::vector<std::string> tables;
  std::vector<std::string> folders;  ///< Folders of images; "" is the folder itself.
};

Found found_in(const std::filesystem::path& folder) {
  Found found;
  if (has_images(folder)) found.folders.emplace_back();
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(error) && has_table_name(entry.path())) found.tables.push_back(name);
    if (entry.is_directory(error) && has_images(entry.path())) found.folders.push_back(name);
  }
  std::ranges::sort(found.tables);
  std::ranges::sort(found.folders);
  return found;
}

std::string listed(const std::vector<std::string>& names) {
  std::vector<std::string> some(names.begin(), names.begin() + std::min<size_t>(names.size(), 5));
  return names.empty() ? "none" : fmt::format("'{}'", fmt::join(some, "', '"));
}

/// Builds the reader of a folder from what is known of it.
class Builder {
 public:
  Builder(std::filesystem::path folder, TableLines lines, const ReadingOptions& options)
      : folder_(std::move(folder)), options_(options), table_{.lines = std::move(lines)} {}

  /// `images`: the folder of the images, relative to `folder`.
  Result<std::unique_ptr<RecordingReader>> build(const std::string& images) {
    // A second reader looks at the first line, so that the table itself is not advanced.
    ENGRAM_ASSIGN_OR_RETURN(TableLines sample, TableLines::open(table_.lines.path()));
    ENGRAM_ASSIGN_OR_RETURN(const bool has_line, sample.next());
    if (!has_line)
      return invalid_argument("'{}': has a header but no lines, needs one for each image",
                              sample.path().string());
    table_.images = folder_ / images;
    find_files(sample);
    ENGRAM_RETURN_IF_ERROR(find_times(sample));
    if (!table_.file_column) ENGRAM_RETURN_IF_ERROR(match_names());
    ENGRAM_RETURN_IF_ERROR(add_images(sample, images.empty() ? "images" : images));
    ENGRAM_RETURN_IF_ERROR(add_numbers(sample));
    std::vector<TimedTable> tables;
    tables.push_back(std::move(table_));
    return TablesReader::create("images", std::move(tables), std::move(met_), options_);
  }

 private:
  void find_files(const TableLines& sample) {
    for (size_t i = 0; i < sample.names().size() && !table_.file_column; ++i)
      if (has_image_name(sample.cell(i))) table_.file_column = i;
    // Names may be relative to the folder of the table.
    if (table_.file_column && file_in_folder(folder_, sample.cell(*table_.file_column)).ok())
      table_.images = folder_;
  }

  Status find_times(const TableLines& sample) {
    const auto& names = sample.names();
    for (size_t i = 0; i < names.size() && !table_.time_column; ++i)
      if (time_name(names[i]).is_time) table_.time_column = i;
    // The table may consist of nothing but times and names.
    const size_t others = table_.file_column ? 2 : 1;
    if (!table_.time_column && !sample.has_names() && names.size() == others)
      table_.time_column = table_.file_column == size_t{0} ? 1 : 0;
    if (options_.rate_hz > 0) {
      if (table_.time_column)
        ++met_.not_carried["column '" + names[*table_.time_column] + "': the rate says when"];
      skipped_ = std::exchange(table_.time_column, std::nullopt);
      table_.rate_hz = options_.rate_hz;
      return {};
    }
    if (table_.time_column) return find_unit(sample);
    return invalid_argument(
        "'{}': found the columns {}, needs one of times as 'timestamp [ns]' or 'time_s', {}",
        sample.path().string(), listed(names), kSayRate);
  }

  Status find_unit(const TableLines& sample) {
    const size_t column = *table_.time_column;
    const std::string& cell = sample.cell(column);
    ENGRAM_ASSIGN_OR_RETURN(const double number, sample.number(column));
    if (const auto unit = time_name(sample.names()[column]).unit)
      table_.unit = *unit;
    else if (cell.find_first_of(".eE") != std::string::npos)
      table_.unit = TimeUnit::kSeconds;
    else if (number > kOnlyNanoseconds)
      table_.unit = TimeUnit::kNanoseconds;
    else
      return sample.broken(
          column,
          fmt::format("needs a unit in the column's name ('timestamp [ns]'), {}", kSayRate));
    return {};
  }

  /// If the table has no names, it must have one line for each image.
  Status match_names() {
    for (const std::string& name : image_names(table_.images)) table_.files.emplace_back(name);
    ENGRAM_ASSIGN_OR_RETURN(TableLines all, TableLines::open(table_.lines.path()));
    uint64_t lines = 0;
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(const bool has_line, all.next());
      if (!has_line) break;
      ++lines;
    }
    if (lines == table_.files.size()) return {};
    return invalid_argument(
        "'{}': has {} lines and '{}' {} images, needs as many, or a column of their names",
        all.path().string(), lines, table_.images.string(), table_.files.size());
  }

  Result<RecordingStream> stream_of(std::string_view memory, std::string_view segment,
                                    const std::string& name) {
    ENGRAM_ASSIGN_OR_RETURN(
        auto entity, ltm::MemoryId::from_names(
                         {std::string(memory), std::string(segment), options_.provider, name}));
    return RecordingStream{std::move(entity), name, 0, {}};
  }

  /// The first image that can be read tells whether the images are depth.
  Status add_images(const TableLines& sample, const std::string& name) {
    const auto first = table_.file_column ? std::filesystem::path(sample.cell(*table_.file_column))
                                          : table_.files.front();
    const auto path = file_in_folder(table_.images, first);
    const auto image = path.ok() ? read_image_file(*path) : Result<idf::NdArray>(path.status());
    const bool is_depth = image.ok() && image->type() == idf::ElementType::kUInt16;
    ENGRAM_ASSIGN_OR_RETURN(auto stream, stream_of("Vision", is_depth ? "Depth" : "RGB", name));
    table_.parts.push_back(
        {std::move(stream), is_depth ? TablePart::Kind::kDepth : TablePart::Kind::kImage, {}});
    return {};
  }

  Status add_numbers(const TableLines& sample) {
    TablePart part;
    for (size_t i = 0; i < sample.names().size(); ++i) {
      if (i == table_.time_column || i == table_.file_column || i == skipped_) continue;
      if (is_number(sample.cell(i)))
        part.members.push_back({sample.names()[i], {i}, false});
      else
        ++met_.not_carried["column '" + sample.names()[i] + "', not of numbers"];
    }
    if (part.members.empty()) return {};
    ENGRAM_ASSIGN_OR_RETURN(
        part.stream, stream_of("RobotState", "Proprioception", sample.path().stem().string()));
    table_.parts.push_back(std::move(part));
    return {};
  }

  std::filesystem::path folder_;
  const ReadingOptions& options_;
  TimedTable table_;
  ReadingReport met_;
  std::optional<size_t> skipped_;  ///< The column of times, if a rate replaces it.
};

}  // namespace

TimeName time_name(std::string_view column) {
  std::vector<std::string> words(1);
  for (const char c : column) {
    const char low = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (low >= 'a' && low <= 'z')
      words.back().push_back(low);
    else if (!words.back().empty())
      words.emplace_back();
  }
  if (words.back().empty()) words.pop_back();
  if (words.empty() || words.size() > 2) return {};
  static const std::vector<std::string> kNames{"timestamp", "timestamps", "time",
                                               "times",     "t",          "stamp"};
  if (std::ranges::find(kNames, words.front()) == kNames.end()) return {};
  if (words.size() == 1) return {true, std::nullopt};
  std::string unit = words.back();
  if (unit == "sec" || unit == "secs" || unit == "seconds") unit = "s";
  if (unit == "nsec" || unit == "nanoseconds") unit = "ns";
  const auto found = parse_time_unit(unit);
  if (!found.ok()) return {};
  return {true, *found};
}

bool is_images_folder(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) return false;
  const Found found = found_in(folder);
  return found.tables.size() == 1 && found.folders.size() == 1;
}

Result<std::unique_ptr<RecordingReader>> open_images_folder(const std::filesystem::path& folder,
                                                            const ReadingOptions& options) {
  if (options.rate_hz != 0 && !(options.rate_hz >= 1e-3 && options.rate_hz <= 1e6))
    return invalid_argument("'{}': a rate of {} Hz, needs 0.001 to 1e6", folder.string(),
                            options.rate_hz);
  const Found found = found_in(folder);
  if (found.folders.size() != 1)
    return invalid_argument("'{}': found images in {} places ({}), needs them in one",
                            folder.string(), found.folders.size(), listed(found.folders));
  if (found.tables.size() != 1)
    return invalid_argument(
        "'{}': found {} tables ({}), needs one, .csv or .txt, that says when its images were",
        folder.string(), found.tables.size(), listed(found.tables));
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(folder, found.tables.front()));
  ENGRAM_ASSIGN_OR_RETURN(TableLines lines, TableLines::open(path));
  return Builder(folder, std::move(lines), options).build(found.folders.front());
}

}  // namespace engram::datasets
