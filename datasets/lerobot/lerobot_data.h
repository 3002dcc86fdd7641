// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what the files below meta/ say.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"

namespace engram::datasets::lerobot {

/// One kind of value, at every step.
struct Feature {
  std::string key;                 ///< "observation.images.cam_high".
  std::string dtype;               ///< "video", "float32", ...
  size_t count = 0;                ///< Numbers a step; 0 for videos.
  std::vector<std::string> names;  ///< Of these numbers; empty where they have none.

  [[nodiscard]] bool is_video() const { return dtype == "video"; }
};

struct Episode {
  int64_t index = 0;
  int64_t length = 0;  ///< Steps.
  std::vector<std::string> tasks;

  [[nodiscard]] std::string name() const;  ///< "episode_000004".
};

struct Description {
  std::filesystem::path root;
  std::string version;  ///< "v2.1".
  std::string robot;
  double rate_hz = 0;
  int64_t chunk_size = 1000;
  std::string data_path;   ///< With {episode_chunk:03d} and {episode_index:06d}.
  std::string video_path;  ///< The same, and {video_key}.
  std::vector<Feature> features;
  std::vector<Episode> episodes;

  [[nodiscard]] std::filesystem::path table_of(const Episode& episode) const;
  [[nodiscard]] std::filesystem::path video_of(const Episode& episode,
                                               const Feature& feature) const;
};

/// Errors: kNotFound where there is no meta/info.json; kInvalidArgument naming the file, what was
/// found and what was needed.
Result<Description> read_description(const std::filesystem::path& root);

}  // namespace engram::datasets::lerobot
