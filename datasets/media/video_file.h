// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstdint>
#include <filesystem>

#include "datasets/media/libav_input.h"
#include "datasets/media/video_reader.h"

namespace engram::datasets {

/// Unit: pixels.
inline constexpr int kMaxVideoSide = 1 << 14;

/// How much the file says there is to read; zeros where it does not.
struct Announced {
  uint64_t packets = 0;
  Duration length{};
};

/// A file that was opened, its video stream, and a decoder that can begin with its first packet.
struct VideoFile {
  libav::Input input;
  AVStream* stream = nullptr;  ///< Of `input`; all other streams are skipped.
  libav::Codec decoder;
  VideoInfo info;
  Announced announced;
};

/// Errors: those of VideoReader::open.
Result<VideoFile> open_video_file(const std::filesystem::path& path, int threads);

/// Rounded to the nearest nanosecond.
[[nodiscard]] Duration duration_of(int64_t ticks, AVRational time_base);

}  // namespace engram::datasets
