// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_episodes.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "datasets/recordings/folder_file.h"

namespace engram::datasets::lerobot {

namespace {

using nlohmann::json;

constexpr size_t kMaxEpisodes = 1'000'000;
constexpr size_t kMaxTasks = 1'000'000;
constexpr size_t kMaxLineBytes = size_t{1} << 20;
constexpr int kMaxDepth = 8;

void collect(const json& value, int depth, std::vector<std::string>& texts) {
  if (value.is_string()) texts.push_back(value.get<std::string>());
  if (value.is_structured() && depth < kMaxDepth)
    for (const json& part : value) collect(part, depth + 1, texts);
}

int64_t whole_member(const json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number_integer() ? found->get<int64_t>() : -1;
}

/// Reads the next line that is not empty; returns false after the last one.
Result<bool> next_object(const std::filesystem::path& path, std::istream& lines, uint64_t& number,
                         json& value) {
  std::string line;
  for (int byte = lines.get(); byte >= 0; byte = lines.get()) {
    if (byte != '\n') line.push_back(static_cast<char>(byte));
    if (line.size() > kMaxLineBytes)
      return invalid_argument("'{}': line {} has more than {} bytes", path.string(), number + 1,
                              kMaxLineBytes);
    if (byte != '\n' && lines.peek() >= 0) continue;
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      line.clear();
      continue;
    }
    value = json::parse(line, nullptr, false);
    if (value.is_object()) return true;
    return invalid_argument("'{}': line {}: found {}, needs a JSON object", path.string(), number,
                            value.is_discarded() ? "no JSON" : value.type_name());
  }
  return false;
}

/// Returns the tasks of a cell, which is a JSON list or a single task.
std::vector<std::string> tasks_of(const std::string& cell) {
  std::vector<std::string> tasks;
  if (const json list = json::parse(cell, nullptr, false); list.is_array())
    collect_texts(list, tasks);
  else if (!cell.empty())
    tasks.push_back(cell);
  return tasks;
}

/// The columns that describe the part of a video that belongs to an episode.
struct VideoColumns {
  size_t chunk = 0;
  size_t file = 0;
  size_t from = 0;
  size_t to = 0;
};

Result<VideoColumns> video_columns(const RowTable& rows, const Feature& feature) {
  const std::string start = "videos/" + feature.key + "/";
  VideoColumns columns;
  ENGRAM_ASSIGN_OR_RETURN(columns.chunk, rows.need(start + "chunk_index"));
  ENGRAM_ASSIGN_OR_RETURN(columns.file, rows.need(start + "file_index"));
  ENGRAM_ASSIGN_OR_RETURN(columns.from, rows.need(start + "from_timestamp"));
  ENGRAM_ASSIGN_OR_RETURN(columns.to, rows.need(start + "to_timestamp"));
  return columns;
}

Result<VideoPart> video_part(const RowTable& rows, const VideoColumns& columns) {
  VideoPart part;
  ENGRAM_ASSIGN_OR_RETURN(part.file.chunk, rows.whole(columns.chunk));
  ENGRAM_ASSIGN_OR_RETURN(part.file.file, rows.whole(columns.file));
  ENGRAM_ASSIGN_OR_RETURN(part.from, rows.seconds(columns.from));
  ENGRAM_ASSIGN_OR_RETURN(part.to, rows.seconds(columns.to));
  if (part.to < part.from) return rows.broken(columns.to, "needs a time behind 'from_timestamp'");
  return part;
}

/// Checks the length against the row numbers, which count from the first row of the data set.
Status check_length(const RowTable& rows, const Episode& episode) {
  const auto from = rows.find({"dataset_from_index"});
  const auto to = rows.find({"dataset_to_index"});
  if (!from || !to) return {};
  ENGRAM_ASSIGN_OR_RETURN(const int64_t first, rows.whole(*from));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t behind, rows.whole(*to));
  if (behind - first == episode.length) return {};
  return rows.broken(*to, fmt::format("needs {} and a length of {}", first, episode.length));
}

/// Returns "chunk-000/file-000.parquet" and the others in order, whether they are Parquet or CSV.
Result<std::set<std::filesystem::path>> episode_tables(const std::filesystem::path& root) {
  std::set<std::filesystem::path> tables;
  const std::filesystem::path folder = root / "meta" / "episodes";
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator entry(folder, error), end;
       !error && entry != end; entry.increment(error)) {
    std::filesystem::path path = entry->path().lexically_relative(root);
    if (path.extension() != ".parquet" && path.extension() != ".csv") continue;
    tables.insert(path.replace_extension(".parquet"));
    if (tables.size() > kMaxEpisodes)
      return invalid_argument("'{}': needs at most {} tables", folder.string(), kMaxEpisodes);
  }
  if (tables.empty())
    return not_found("'{}': has no chunk-000/file-000.parquet with the episodes of the data set",
                     folder.string());
  return tables;
}

Status check_numbers(const Description& description, const std::vector<Episode>& episodes) {
  const auto twice = std::ranges::adjacent_find(episodes, {}, &Episode::index);
  if (twice == episodes.end()) return {};
  return invalid_argument("'{}': episode {} is there twice", (description.root / "meta").string(),
                          twice->index);
}

Result<std::vector<Episode>> read_episode_tables(const Description& description) {
  std::vector<Episode> episodes;
  ENGRAM_ASSIGN_OR_RETURN(const auto tables, episode_tables(description.root));
  for (const auto& table : tables) {
    ENGRAM_ASSIGN_OR_RETURN(RowTable rows, RowTable::open(description.root, table, false));
    ENGRAM_ASSIGN_OR_RETURN(auto found, parse_episode_rows(description, rows));
    std::ranges::move(found, std::back_inserter(episodes));
  }
  return episodes;
}

Result<std::map<int64_t, std::string>> task_lines(const std::filesystem::path& path,
                                                  std::istream& lines) {
  std::map<int64_t, std::string> tasks;
  uint64_t number = 0;
  json value;
  while (tasks.size() < kMaxTasks) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_line, next_object(path, lines, number, value));
    if (!has_line) return tasks;
    const auto text = value.find("task");
    const int64_t index = whole_member(value, "task_index");
    if (index < 0 || text == value.end() || !text->is_string())
      return invalid_argument("'{}': line {}: needs a 'task_index' and a 'task'", path.string(),
                              number);
    tasks[index] = text->get<std::string>();
  }
  return invalid_argument("'{}': needs less than {} tasks", path.string(), kMaxTasks);
}

Result<std::map<int64_t, std::string>> task_rows(RowTable& rows) {
  std::map<int64_t, std::string> tasks;
  ENGRAM_ASSIGN_OR_RETURN(const size_t index, rows.need("task_index"));
  // The text is the index of a pandas frame, which Parquet stores as a separate column.
  const auto unnamed = rows.find({"__index_level_0__"});
  ENGRAM_ASSIGN_OR_RETURN(const size_t task,
                          unnamed ? Result<size_t>(*unnamed) : rows.need("task"));
  while (tasks.size() < kMaxTasks) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_row, rows.next());
    if (!has_row) return tasks;
    ENGRAM_ASSIGN_OR_RETURN(const int64_t number, rows.whole(index));
    tasks[number] = rows.text(task);
  }
  return rows.broken(index, fmt::format("needs less than {} tasks", kMaxTasks));
}

}  // namespace

void collect_texts(const json& value, std::vector<std::string>& texts) {
  collect(value, 0, texts);
}

Result<std::vector<Episode>> parse_episode_lines(const std::filesystem::path& path,
                                                 std::istream& lines) {
  std::vector<Episode> episodes;
  uint64_t number = 0;
  json value;
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_line, next_object(path, lines, number, value));
    if (!has_line) return episodes;
    Episode episode;
    episode.index = whole_member(value, "episode_index");
    episode.length = whole_member(value, "length");
    if (episode.index < 0 || episode.length < 0)
      return invalid_argument("'{}': line {}: needs an 'episode_index' and a 'length' of 0 or more",
                              path.string(), number);
    if (episodes.size() >= kMaxEpisodes)
      return invalid_argument("'{}': line {}: needs at most {} episodes", path.string(), number,
                              kMaxEpisodes);
    if (const auto tasks = value.find("tasks"); tasks != value.end())
      collect_texts(*tasks, episode.tasks);
    episodes.push_back(std::move(episode));
  }
}

Result<std::vector<Episode>> parse_episode_rows(const Description& description, RowTable& rows) {
  ENGRAM_ASSIGN_OR_RETURN(const size_t index, rows.need("episode_index"));
  ENGRAM_ASSIGN_OR_RETURN(const size_t length, rows.need("length"));
  ENGRAM_ASSIGN_OR_RETURN(const size_t chunk, rows.need("data/chunk_index"));
  ENGRAM_ASSIGN_OR_RETURN(const size_t file, rows.need("data/file_index"));
  const auto tasks = rows.find({"tasks"});
  std::vector<VideoColumns> videos;
  for (const Feature& feature : description.features) {
    if (feature.kind != Feature::Kind::kVideo) continue;
    ENGRAM_ASSIGN_OR_RETURN(const VideoColumns columns, video_columns(rows, feature));
    videos.push_back(columns);
  }
  std::vector<Episode> episodes;
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(const bool has_row, rows.next());
    if (!has_row) return episodes;
    if (episodes.size() >= kMaxEpisodes)
      return rows.broken(index, fmt::format("needs at most {} episodes", kMaxEpisodes));
    Episode& episode = episodes.emplace_back();
    ENGRAM_ASSIGN_OR_RETURN(episode.index, rows.whole(index));
    ENGRAM_ASSIGN_OR_RETURN(episode.length, rows.whole(length));
    ENGRAM_ASSIGN_OR_RETURN(episode.table.chunk, rows.whole(chunk));
    ENGRAM_ASSIGN_OR_RETURN(episode.table.file, rows.whole(file));
    ENGRAM_RETURN_IF_ERROR(check_length(rows, episode));
    if (tasks) episode.tasks = tasks_of(rows.text(*tasks));
    for (const VideoColumns& columns : videos) {
      ENGRAM_ASSIGN_OR_RETURN(const VideoPart part, video_part(rows, columns));
      episode.videos.push_back(part);
    }
  }
}

Result<std::vector<Episode>> read_episodes(const Description& description) {
  std::vector<Episode> episodes;
  if (description.is_v3) {
    ENGRAM_ASSIGN_OR_RETURN(episodes, read_episode_tables(description));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(const auto path,
                            file_in_folder(description.root, "meta/episodes.jsonl"));
    std::ifstream lines(path, std::ios::binary);
    ENGRAM_ASSIGN_OR_RETURN(episodes, parse_episode_lines(path, lines));
  }
  std::ranges::sort(episodes, {}, &Episode::index);
  ENGRAM_RETURN_IF_ERROR(check_numbers(description, episodes));
  return episodes;
}

Result<std::map<int64_t, std::string>> read_tasks(const Description& description) {
  const std::filesystem::path name = description.is_v3 ? "meta/tasks.parquet" : "meta/tasks.jsonl";
  std::error_code error;
  const bool is_there = std::filesystem::exists(description.root / name, error) ||
                        (description.is_v3 && !csv_of(description.root, name, false).empty());
  if (!is_there) return std::map<int64_t, std::string>();
  if (description.is_v3) {
    ENGRAM_ASSIGN_OR_RETURN(RowTable rows, RowTable::open(description.root, name, false));
    return task_rows(rows);
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(description.root, name));
  std::ifstream lines(path, std::ios::binary);
  return task_lines(path, lines);
}

}  // namespace engram::datasets::lerobot
