// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_data.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "ltm/core/file.h"

namespace engram::datasets::lerobot {

namespace {

using nlohmann::json;

constexpr size_t kMostNumbers = 1'000'000;
constexpr size_t kMostEpisodes = 10'000'000;

Result<json> parsed(const std::filesystem::path& path, const std::string& text, size_t line) {
  json value = json::parse(text, nullptr, false);
  if (value.is_object()) return value;
  return invalid_argument("'{}', line {}: is no JSON object", path.string(), line);
}

Result<std::string> text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return not_found("'{}': there is no such file", path.string());
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// A member of a type, or what stands for it where it is missing.
template <typename Value>
Value member(const json& object, const char* name, Value otherwise) {
  const auto found = object.find(name);
  if (found == object.end()) return otherwise;
  if constexpr (std::is_same_v<Value, std::string>) {
    return found->is_string() ? found->get<Value>() : otherwise;
  } else if constexpr (std::is_integral_v<Value>) {
    return found->is_number_integer() ? found->get<Value>() : otherwise;
  } else {
    return found->is_number() ? found->get<Value>() : otherwise;
  }
}

/// Names come as a list, as a list of lists, or as a list by the name of an axis.
void collect_names(const json& value, std::vector<std::string>& names) {
  if (value.is_string()) names.push_back(value.get<std::string>());
  if (value.is_array() || value.is_object())
    for (const json& part : value) collect_names(part, names);
}

Result<Feature> feature_of(const std::filesystem::path& path, const std::string& key,
                           const json& value) {
  Feature feature;
  feature.key = key;
  feature.dtype = member<std::string>(value, "dtype", "");
  if (feature.is_video() || feature.dtype == "image") return feature;
  feature.count = 1;
  const auto shape = value.find("shape");
  if (shape == value.end() || !shape->is_array())
    return invalid_argument("'{}': feature '{}' needs a 'shape'", path.string(), key);
  for (const json& size : *shape) {
    const auto extent = size.is_number_unsigned() ? size.get<uint64_t>() : kMostNumbers + 1;
    feature.count = extent > kMostNumbers ? kMostNumbers + 1 : feature.count * extent;
    if (feature.count > kMostNumbers)
      return invalid_argument("'{}': feature '{}': needs a shape of at most {} numbers",
                              path.string(), key, kMostNumbers);
  }
  if (const auto names = value.find("names"); names != value.end())
    collect_names(*names, feature.names);
  if (feature.names.size() != feature.count) feature.names.clear();
  return feature;
}

Result<std::vector<Episode>> read_episodes(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file)
    return not_found("'{}': there is no such file, needs the episodes of the data set",
                     path.string());
  std::vector<Episode> episodes;
  size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ENGRAM_ASSIGN_OR_RETURN(const json value, parsed(path, line, number));
    Episode episode;
    episode.index = member<int64_t>(value, "episode_index", -1);
    episode.length = member<int64_t>(value, "length", -1);
    if (episode.index < 0 || episode.length < 0 || episodes.size() >= kMostEpisodes)
      return invalid_argument("'{}', line {}: needs an 'episode_index' and a 'length'",
                              path.string(), number);
    if (const auto tasks = value.find("tasks"); tasks != value.end())
      collect_names(*tasks, episode.tasks);
    episodes.push_back(std::move(episode));
  }
  return episodes;
}

/// "a{x:03d}" with x 7 becomes "a007".
std::string filled(std::string text, const std::string& name, const std::string& value) {
  for (size_t at = text.find('{' + name); at != std::string::npos; at = text.find('{' + name, at)) {
    const size_t end = text.find('}', at);
    if (end == std::string::npos) break;
    size_t width = 0;
    if (const size_t colon = text.find(':', at); colon < end)
      width = static_cast<size_t>(std::strtoul(text.c_str() + colon + 1, nullptr, 10));
    const size_t zeros = std::min<size_t>(width, 32);
    const std::string padded =
        value.size() < zeros ? std::string(zeros - value.size(), '0') + value : value;
    text.replace(at, end - at + 1, padded);
    at += padded.size();
  }
  return text;
}

std::string filled(const Description& description, const std::string& text,
                   const Episode& episode) {
  const int64_t chunk = episode.index / description.chunk_size;
  return filled(filled(text, "episode_chunk", std::to_string(chunk)), "episode_index",
                std::to_string(episode.index));
}

}  // namespace

std::string Episode::name() const {
  return fmt::format("episode_{:06}", index);
}

std::filesystem::path Description::table_of(const Episode& episode) const {
  return root / filled(*this, data_path, episode);
}

std::filesystem::path Description::video_of(const Episode& episode, const Feature& feature) const {
  return root / filled(filled(*this, video_path, episode), "video_key", feature.key);
}

Result<Description> read_description(const std::filesystem::path& root) {
  const std::filesystem::path path = root / "meta" / "info.json";
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, text_of(path));
  ENGRAM_ASSIGN_OR_RETURN(const json info, parsed(path, text, 1));
  Description description;
  description.root = root;
  description.version = member<std::string>(info, "codebase_version", "");
  if (!description.version.starts_with("v2"))
    return invalid_argument("'{}': found version '{}', needs v2.0 or v2.1", path.string(),
                            description.version);
  description.robot = member<std::string>(info, "robot_type", "");
  description.rate_hz = member<double>(info, "fps", 0);
  if (!(description.rate_hz > 0 && description.rate_hz <= 1e6))
    return invalid_argument("'{}': needs an 'fps' above 0", path.string());
  description.chunk_size = std::max<int64_t>(1, member<int64_t>(info, "chunks_size", 1000));
  description.data_path = member<std::string>(info, "data_path", "");
  description.video_path = member<std::string>(info, "video_path", "");
  const auto features = info.find("features");
  if (description.data_path.empty() || features == info.end() || !features->is_object())
    return invalid_argument("'{}': needs a 'data_path' and 'features'", path.string());
  for (const auto& [key, value] : features->items()) {
    ENGRAM_ASSIGN_OR_RETURN(Feature feature, feature_of(path, key, value));
    description.features.push_back(std::move(feature));
  }
  ENGRAM_ASSIGN_OR_RETURN(description.episodes, read_episodes(root / "meta" / "episodes.jsonl"));
  return description;
}

}  // namespace engram::datasets::lerobot
