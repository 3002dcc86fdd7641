// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets {

/// Writes images as H.264 in an MP4 file that players and browsers start before it is whole.
///
/// Colours are BT.709, limited range, and the file says so. Equal images and options give equal
/// bytes. The file appears under its name only once it is closed.
/// Time: image i lies exactly i * rate_denominator / rate_numerator seconds after the first, or,
/// with `has_times`, where the caller puts it, to 1/90000 s. Threading: one thread; the encoder
/// starts its own.
class VideoWriter {
 public:
  struct Options {
    /// Size of every image. Even, unless `keeps_chroma`. Unit: pixels.
    int width = 0;
    int height = 0;
    /// Images per second, as a fraction: 30000 / 1001 is one.
    int rate_numerator = 30;
    int rate_denominator = 1;
    /// Constant quality of libx264: 0 is nearly lossless, 18 looks so, 51 is worst.
    int crf = 18;
    /// Slower presets of libx264 give smaller files: "ultrafast" ... "medium" ... "veryslow".
    std::string preset = "medium";
    /// Store colour at full resolution (4:4:4). Exact colours, but browsers do not play it.
    bool keeps_chroma = false;
    /// Images come with their times; the rate is what the file says of itself.
    bool has_times = false;
    /// Part of what makes equal bytes: another number may give other bytes.
    int threads = 2;
    /// Written into the file as the time of recording.
    std::optional<Time> created;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate or libx264 refuses them; kUnavailable.
  static Result<VideoWriter> create(const std::filesystem::path& path, const Options& options);

  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Without close() nothing is left of the file.
  ~VideoWriter();

  /// Shape: image uint8 [height, width, 3], RGB.
  /// Errors: kInvalidArgument where it has another shape; kUnavailable, kResourceExhausted.
  Status write(const idf::NdArray& image);

  /// With `has_times` only (checked): an image that is seen from `since_first` on, 0 for the first.
  /// Times that do not increase count as 1/90000 s after the one before.
  Status write(const idf::NdArray& image, Duration since_first);

  /// Finishes the file and moves it to its name, replacing what is there. Nothing may follow.
  /// Errors: kUnavailable, kResourceExhausted.
  Status close();

 private:
  struct State;
  explicit VideoWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets
