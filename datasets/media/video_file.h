// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstdint>
#include <filesystem>

#include "datasets/media/libav_input.h"
#include "datasets/media/video_reader.h"

namespace engram::datasets {

/// Maximum width and height. Unit: pixels.
inline constexpr int kMaxVideoSide = 1 << 14;

/// The amount of data that the file announces; zero if it does not.
struct Announced {
  uint64_t packets = 0;
  Duration length{};
};

/// An open file, its video stream, and a decoder that can start with the first packet.
struct VideoFile {
  libav::Input input;
  AVStream* stream = nullptr;  ///< Belongs to `input`; all other streams are skipped.
  libav::Codec decoder;
  VideoInfo info;
  Announced announced;
};

/// Errors: those of VideoReader::open.
Result<VideoFile> open_video_file(const std::filesystem::path& path, int threads);

/// Converts ticks to a duration, rounded to the nearest nanosecond.
[[nodiscard]] Duration duration_of(int64_t ticks, AVRational time_base);

}  // namespace engram::datasets
