// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the video of a camera, read frame by frame.

#include <optional>

#include "datasets/media/video_reader.h"

namespace engram::datasets::lerobot {

/// Reads a video that contains one or more episodes, one after the other.
///
/// A video that breaks ends there, and broken() says so. Memory: two frames and the decoder's.
/// Threading: one thread.
class EpisodeVideo {
 public:
  /// Errors: those of VideoReader::open.
  static Result<EpisodeVideo> open(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Drops frames before `time`. Returns false if later frames were already dropped or taken.
  bool skip_to(Duration time);

  /// Returns the next frame; nothing after the last one.
  std::optional<idf::NdArray> next();

  /// Returns the frame that is less than `tolerance` from `time`. Frames before it are dropped and
  /// counted.
  std::optional<idf::NdArray> at(Duration time, Duration tolerance);

  /// Drops frames before `time` and counts them.
  void pass_to(Duration time);

  /// The number of frames that were dropped and counted.
  [[nodiscard]] uint64_t passed() const { return passed_; }
  [[nodiscard]] uint64_t damaged() const { return reader_.damaged_frames(); }

  /// Says where and how the video breaks; empty if it does not.
  [[nodiscard]] const std::string& broken() const { return broken_; }

 private:
  EpisodeVideo(std::filesystem::path path, VideoReader reader)
      : path_(std::move(path)), reader_(std::move(reader)) {}

  /// Decodes the next frame if it is not there yet; returns false after the last one.
  bool fetch();

  std::filesystem::path path_;
  VideoReader reader_;
  std::optional<DecodedFrame> frame_;   ///< The next frame.
  Duration reached_ = Duration::min();  ///< The time of the last frame that was taken or dropped.
  uint64_t passed_ = 0;
  std::string broken_;
  bool is_over_ = false;
};

}  // namespace engram::datasets::lerobot
