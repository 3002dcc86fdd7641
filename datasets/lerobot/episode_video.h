// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the video of a camera, frame by frame.

#include <optional>

#include "datasets/media/video_reader.h"

namespace engram::datasets::lerobot {

/// Reads a video that one episode or several are in, one behind the other.
///
/// A video that breaks ends there; broken() says so. Memory: two frames and the decoder's.
/// Threading: one thread.
class EpisodeVideo {
 public:
  /// Errors: those of VideoReader::open.
  static Result<EpisodeVideo> open(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Drops frames before `time`; false where frames from there on are gone already.
  bool skip_to(Duration time);

  /// The next frame, nothing behind the last.
  std::optional<idf::NdArray> next();

  /// The frame that is less than `tolerance` from `time`. Those before it are dropped and counted.
  std::optional<idf::NdArray> at(Duration time, Duration tolerance);

  /// Drops frames before `time` and counts them.
  void pass_to(Duration time);

  /// Frames that were dropped and counted.
  [[nodiscard]] uint64_t passed() const { return passed_; }
  [[nodiscard]] uint64_t damaged() const { return reader_.damaged_frames(); }

  /// Where and how the video breaks; empty where it does not.
  [[nodiscard]] const std::string& broken() const { return broken_; }

 private:
  EpisodeVideo(std::filesystem::path path, VideoReader reader)
      : path_(std::move(path)), reader_(std::move(reader)) {}

  /// Fetches the next frame, if it is not there yet; false behind the last.
  bool fetch();

  std::filesystem::path path_;
  VideoReader reader_;
  std::optional<DecodedFrame> frame_;   ///< The next one.
  Duration reached_ = Duration::min();  ///< Time of the last one that was taken or dropped.
  uint64_t passed_ = 0;
  std::string broken_;
  bool is_over_ = false;
};

}  // namespace engram::datasets::lerobot
