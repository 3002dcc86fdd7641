// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "datasets/lerobot/lerobot_episodes.h"
#include "datasets/recordings/folder_file.h"
#include "ltm/core/file.h"

namespace engram::datasets::lerobot {

namespace {

using nlohmann::json;

constexpr size_t kMaxNumbers = 1'000'000;
constexpr size_t kMaxFeatures = 10'000;
constexpr size_t kMaxInfoBytes = size_t{64} << 20;
constexpr size_t kMaxShown = 40;
constexpr double kLowestHz = 1e-3;
constexpr double kHighestHz = 1e6;

/// Shows the value of a member in a message.
std::string shown(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) return "nothing";
  if (found->is_structured()) return found->type_name();
  const std::string text = found->dump(-1, ' ', false, json::error_handler_t::replace);
  return text.size() > kMaxShown ? text.substr(0, kMaxShown) + "..." : text;
}

std::string text_member(const json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

Feature::Kind kind_of(const std::string& dtype) {
  if (dtype == "video") return Feature::Kind::kVideo;
  if (dtype == "image") return Feature::Kind::kImage;
  return dtype == "string" ? Feature::Kind::kText : Feature::Kind::kNumbers;
}

Result<Feature> feature_of(const std::filesystem::path& path, const std::string& key,
                           const json& value) {
  Feature feature;
  feature.key = key;
  if (!value.is_object())
    return invalid_argument("'{}': feature '{}': needs an object", path.string(), key);
  feature.dtype = text_member(value, "dtype");
  feature.kind = kind_of(feature.dtype);
  if (feature.is_picture()) return feature;
  const auto shape = value.find("shape");
  if (shape == value.end() || !shape->is_array())
    return invalid_argument("'{}': feature '{}': found {} as its 'shape', needs a list",
                            path.string(), key, shown(value, "shape"));
  feature.count = 1;
  for (const json& size : *shape) {
    const auto extent = size.is_number_unsigned() ? size.get<uint64_t>() : kMaxNumbers + 1;
    feature.count = extent > kMaxNumbers ? kMaxNumbers + 1 : feature.count * extent;
    if (feature.count == 0 || feature.count > kMaxNumbers)
      return invalid_argument("'{}': feature '{}': needs a 'shape' of 1 to {} numbers",
                              path.string(), key, kMaxNumbers);
    feature.shape.push_back(static_cast<int64_t>(extent));
  }
  if (feature.shape.empty()) feature.shape.push_back(1);
  if (const auto names = value.find("names"); names != value.end())
    collect_texts(*names, feature.names);
  std::vector<std::string> sorted = feature.names;
  std::ranges::sort(sorted);
  // Names of axes, or names that would collide, are not names of the numbers.
  if (sorted.size() != feature.count || std::ranges::adjacent_find(sorted) != sorted.end())
    feature.names.clear();
  return feature;
}

/// Turns "a{x:03d}" into "a007" for name x and value 7.
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

std::string filled(const Description& description, std::string text, const Episode& episode,
                   const FileIndex& file) {
  text = filled(std::move(text), "episode_chunk",
                std::to_string(episode.index / description.chunk_size));
  text = filled(std::move(text), "episode_index", std::to_string(episode.index));
  text = filled(std::move(text), "chunk_index", std::to_string(file.chunk));
  return filled(std::move(text), "file_index", std::to_string(file.file));
}

Status check_template(const std::filesystem::path& path, const json& info, const char* name) {
  const std::filesystem::path text = text_member(info, name);
  const bool has_video = info.contains(name) && !info.at(name).is_null();
  if (std::string_view(name) == "video_path" && !has_video) return {};
  // The path comes from the data set, which is not trusted, so it must not lead out of it.
  if (!text.empty() && text.is_relative() && std::ranges::find(text, "..") == text.end()) return {};
  return invalid_argument("'{}': found {} as '{}', needs a path inside of the data set",
                          path.string(), shown(info, name), name);
}

Status read_numbers(const std::filesystem::path& path, const json& info, Description& description) {
  const auto fps = info.find("fps");
  description.rate_hz = fps != info.end() && fps->is_number() ? fps->get<double>() : 0;
  if (!(description.rate_hz >= kLowestHz && description.rate_hz <= kHighestHz))
    return invalid_argument("'{}': found {} as 'fps', needs {} to {}", path.string(),
                            shown(info, "fps"), kLowestHz, kHighestHz);
  const auto size = info.find("chunks_size");
  if (size == info.end()) return {};
  description.chunk_size = size->is_number_integer() ? size->get<int64_t>() : 0;
  if (description.chunk_size < 1)
    return invalid_argument("'{}': found {} as 'chunks_size', needs 1 or more", path.string(),
                            shown(info, "chunks_size"));
  return {};
}

}  // namespace

std::string Episode::name() const {
  return fmt::format("episode_{:06}", index);
}

std::filesystem::path Description::table_of(const Episode& episode) const {
  return filled(*this, data_path, episode, episode.table);
}

std::filesystem::path Description::video_of(const Episode& episode, const Feature& feature,
                                            size_t video) const {
  const FileIndex file = is_v3 ? episode.videos[video].file : FileIndex();
  return filled(filled(*this, video_path, episode, file), "video_key", feature.key);
}

Result<Description> parse_info(const std::filesystem::path& root, const std::string& text) {
  const std::filesystem::path path = root / "meta" / "info.json";
  if (text.empty()) return invalid_argument("'{}': is empty, needs a JSON object", path.string());
  const json info = json::parse(text, nullptr, false);
  if (!info.is_object())
    return invalid_argument("'{}': found {}, needs a JSON object", path.string(),
                            info.is_discarded() ? "no JSON" : info.type_name());
  Description description;
  description.root = root;
  description.version = text_member(info, "codebase_version");
  description.is_v3 = description.version.starts_with("v3.");
  if (!description.is_v3 && !description.version.starts_with("v2."))
    return invalid_argument("'{}': found {} as 'codebase_version', needs v2.0, v2.1 or v3.0",
                            path.string(), shown(info, "codebase_version"));
  description.robot = text_member(info, "robot_type");
  ENGRAM_RETURN_IF_ERROR(read_numbers(path, info, description));
  for (const char* name : {"data_path", "video_path"})
    ENGRAM_RETURN_IF_ERROR(check_template(path, info, name));
  description.data_path = text_member(info, "data_path");
  description.video_path = text_member(info, "video_path");
  const auto features = info.find("features");
  if (features == info.end() || !features->is_object() || features->size() > kMaxFeatures)
    return invalid_argument("'{}': found {} as 'features', needs an object of at most {}",
                            path.string(), shown(info, "features"), kMaxFeatures);
  for (const auto& [key, value] : features->items()) {
    ENGRAM_ASSIGN_OR_RETURN(Feature feature, feature_of(path, key, value));
    if (feature.kind == Feature::Kind::kVideo && description.video_path.empty())
      return invalid_argument("'{}': has videos, needs a 'video_path'", path.string());
    description.features.push_back(std::move(feature));
  }
  return description;
}

Result<Description> read_description(const std::filesystem::path& root) {
  ENGRAM_ASSIGN_OR_RETURN(const auto path, file_in_folder(root, "meta/info.json"));
  std::error_code error;
  if (const auto bytes = std::filesystem::file_size(path, error); bytes > kMaxInfoBytes)
    return invalid_argument("'{}': found {} bytes, needs at most {}", path.string(), bytes,
                            kMaxInfoBytes);
  ENGRAM_ASSIGN_OR_RETURN(const Buffer text, read_file(path));
  ENGRAM_ASSIGN_OR_RETURN(Description description,
                          parse_info(root, std::string(as_text(text.bytes()))));
  ENGRAM_ASSIGN_OR_RETURN(description.episodes, read_episodes(description));
  return description;
}

}  // namespace engram::datasets::lerobot
