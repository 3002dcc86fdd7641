// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the files below meta/ say.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets::lerobot {

/// One kind of value, at every step.
struct Feature {
  enum class Kind : uint8_t { kNumbers, kText, kImage, kVideo };

  std::string key;    ///< "observation.images.cam_high".
  std::string dtype;  ///< "video", "image", "string", "float32", ...
  Kind kind = Kind::kNumbers;
  idf::Shape shape;                ///< Of numbers and texts: one or more.
  size_t count = 0;                ///< Numbers a step; 0 for images.
  std::vector<std::string> names;  ///< Of these numbers; empty where they have none.

  [[nodiscard]] bool is_picture() const { return kind == Kind::kImage || kind == Kind::kVideo; }
};

/// Which file of many, from v3 on.
struct FileIndex {
  int64_t chunk = 0;
  int64_t file = 0;
};

/// What of a video is an episode. v2 has a video per episode.
struct VideoPart {
  FileIndex file;
  Duration from{};
  Duration to = Duration::max();
};

struct Episode {
  int64_t index = 0;
  int64_t length = 0;  ///< Steps.
  std::vector<std::string> tasks;
  FileIndex table;                ///< From v3 on.
  std::vector<VideoPart> videos;  ///< From v3 on: one for each feature that is a video, in order.

  [[nodiscard]] std::string name() const;  ///< "episode_000004".
};

struct Description {
  std::filesystem::path root;
  std::string version;  ///< "v2.1".
  bool is_v3 = false;   ///< Many episodes share files.
  std::string robot;
  double rate_hz = 0;
  int64_t chunk_size = 1000;
  std::string data_path;   ///< With {episode_chunk:03d}, {episode_index:06d} or, from v3 on,
                           ///< {chunk_index:03d}, {file_index:03d}.
  std::string video_path;  ///< The same, and {video_key}.
  std::vector<Feature> features;
  std::vector<Episode> episodes;

  /// In `root`; whether they stay there is not said.
  [[nodiscard]] std::filesystem::path table_of(const Episode& episode) const;
  /// `video` counts the features that are videos.
  [[nodiscard]] std::filesystem::path video_of(const Episode& episode, const Feature& feature,
                                               size_t video) const;
};

/// Reads what meta/info.json says; without episodes. Safe on hostile text.
/// Errors: kInvalidArgument naming the file, what was found and what was needed.
Result<Description> parse_info(const std::filesystem::path& root, const std::string& text);

/// Errors: kNotFound where there is no meta/info.json; those of parse_info and read_episodes.
Result<Description> read_description(const std::filesystem::path& root);

}  // namespace engram::datasets::lerobot
