// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the contents of the files below meta/.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets::lerobot {

/// One kind of value; every step has one of it.
struct Feature {
  enum class Kind : uint8_t { kNumbers, kText, kImage, kVideo };

  std::string key;    ///< "observation.images.cam_high".
  std::string dtype;  ///< "video", "image", "string", "float32", ...
  Kind kind = Kind::kNumbers;
  idf::Shape shape;                ///< For numbers and texts: one or more.
  size_t count = 0;                ///< Numbers per step; 0 for images.
  std::vector<std::string> names;  ///< Names of these numbers; empty if they have none.

  [[nodiscard]] bool is_picture() const { return kind == Kind::kImage || kind == Kind::kVideo; }
};

/// Selects one of many files, from v3 on.
struct FileIndex {
  int64_t chunk = 0;
  int64_t file = 0;
};

/// The part of a video that belongs to an episode. In v2 each episode has its own video.
struct VideoPart {
  FileIndex file;
  Duration from{};
  Duration to = Duration::max();
};

struct Episode {
  int64_t index = 0;
  int64_t length = 0;  ///< Number of steps.
  std::vector<std::string> tasks;
  FileIndex table;                ///< Used from v3 on.
  std::vector<VideoPart> videos;  ///< Used from v3 on: one for each video feature, in order.

  /// Returns "episode_000004".
  [[nodiscard]] std::string name() const;
};

struct Description {
  std::filesystem::path root;
  std::string version;  ///< "v2.1".
  bool is_v3 = false;   ///< True if episodes share files.
  std::string robot;
  double rate_hz = 0;
  int64_t chunk_size = 1000;
  /// Has the fields {episode_chunk:03d}, {episode_index:06d} or, from v3 on, {chunk_index:03d},
  /// {file_index:03d}.
  std::string data_path;
  std::string video_path;  ///< As data_path, and {video_key}.
  std::vector<Feature> features;
  std::vector<Episode> episodes;

  /// Returns a path in `root`; links may still lead out of it.
  [[nodiscard]] std::filesystem::path table_of(const Episode& episode) const;
  /// `video` is the index among the features that are videos.
  [[nodiscard]] std::filesystem::path video_of(const Episode& episode, const Feature& feature,
                                               size_t video) const;
};

/// Parses meta/info.json, without episodes. Safe on hostile text.
/// Errors: kInvalidArgument naming the file, what was found and what was needed.
Result<Description> parse_info(const std::filesystem::path& root, const std::string& text);

/// Errors: kNotFound if there is no meta/info.json; those of parse_info and read_episodes.
Result<Description> read_description(const std::filesystem::path& root);

}  // namespace engram::datasets::lerobot
