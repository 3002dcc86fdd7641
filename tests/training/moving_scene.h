// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/file.h"
#include "ltm/idf/data.h"
#include "training/fit/trainer.h"

namespace engram::testing {

inline constexpr int kHeight = 40, kWidth = 48;

/// A bright square that moves over a shaded ground, 48 x 40 (no multiple of 16), and two joints.
inline idf::Data scene_at(int i, bool has_image = true, bool has_numbers = true) {
  idf::Dict dict;
  if (has_image) {
    const int left = (i * 2) % (kWidth - 12);
    std::vector<uint8_t> pixels;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool is_square = x >= left && x < left + 12 && y >= 14 && y < 26;
        pixels.push_back(static_cast<uint8_t>(is_square ? 230 : 40 + x));
        pixels.push_back(static_cast<uint8_t>(is_square ? 60 : 40 + 2 * y));
        pixels.push_back(static_cast<uint8_t>(is_square ? 40 : 90));
      }
    dict.set("image", idf::NdArray::take<uint8_t>({kHeight, kWidth, 3}, std::move(pixels)));
  }
  if (has_numbers) {
    dict.set("joints", idf::NdArray::take<double>({2}, {std::sin(i * 0.2), 3 + std::cos(i * 0.2)}));
    dict.set("load", 0.5 + 0.25 * std::sin(i * 0.4));
  }
  dict.set("label", "square " + std::to_string(i));
  return dict;
}

/// `count` values at 5 Hz, cut into `recordings` of equal length.
inline training::TrainingSource scene_source(int count, int recordings = 1, bool has_image = true,
                                             bool has_numbers = true) {
  training::TrainingSource source;
  source.entity = "Test/Scene/sim/square";
  for (int i = 0; i < count; ++i)
    source.times.push_back(Time(std::chrono::milliseconds(200 * i) +
                                std::chrono::seconds(60 * (i * recordings / count))));
  source.read = [=](size_t i) -> Result<idf::Data> {
    return scene_at(static_cast<int>(i), has_image, has_numbers);
  };
  return source;
}

/// Few steps on one thread: what a test can wait for.
inline training::TrainOptions quick_options(int steps) {
  training::TrainOptions options;
  options.steps = steps;
  options.threads = 1;
  options.width = 16;
  options.coarse_channels = 12;
  return options;
}

/// A path that nothing is at, removed with everything in it at the end.
class ScratchPath {
 public:
  explicit ScratchPath(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("engram_" + name + "_" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path_);
  }
  ~ScratchPath() { std::filesystem::remove_all(path_); }
  ScratchPath(const ScratchPath&) = delete;
  ScratchPath& operator=(const ScratchPath&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The bytes of a file; empty if there is none.
inline std::string content_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : std::string();
}

}  // namespace engram::testing
