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

/// Writes images as H.264 in an MP4 file that players and browsers can start to play before it is
/// completely downloaded.
///
/// Colours are BT.709, limited range, and the file says so. Equal images and options give equal
/// bytes. The file appears under its name only when it is closed.
/// Time: image i is exactly i * rate_denominator / rate_numerator seconds after the first or, with
/// `has_times`, at the time that the caller gives, to 1/90000 s. Threading: one thread; the encoder
/// starts its own.
class VideoWriter {
 public:
  struct Options {
    /// Size of every image. Must be even unless `keeps_chroma` is set. Unit: pixels.
    int width = 0;
    int height = 0;
    /// Images per second as a fraction, such as 30000 / 1001.
    int rate_numerator = 30;
    int rate_denominator = 1;
    /// Constant quality of libx264: 0 is nearly lossless, 18 looks lossless, 51 is the worst.
    int crf = 18;
    /// Slower presets of libx264 give smaller files: "ultrafast" ... "medium" ... "veryslow".
    std::string preset = "medium";
    /// Store colour at full resolution (4:4:4). Colours are exact, but browsers do not play it.
    bool keeps_chroma = false;
    /// Every image has its own time, and the rate is only the nominal rate in the file.
    bool has_times = false;
    /// Threads of the encoder. Equal bytes need an equal number.
    int threads = 2;
    /// The time of recording that is written into the file.
    std::optional<Time> created;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate or libx264 refuses them; kUnavailable.
  static Result<VideoWriter> create(const std::filesystem::path& path, const Options& options);

  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// Removes the file if it was not closed.
  ~VideoWriter();

  /// Shape: image uint8 [height, width, 3], RGB.
  /// Errors: kInvalidArgument if it has another shape; kUnavailable, kResourceExhausted.
  Status write(const idf::NdArray& image);

  /// Only with `has_times` (checked): writes an image that is shown from `since_first` on, which is
  /// 0 for the first one. A time that does not increase becomes 1/90000 s after the previous one.
  Status write(const idf::NdArray& image, Duration since_first);

  /// Completes the file and renames it, replacing any existing file. No other call may follow.
  /// Errors: kUnavailable, kResourceExhausted.
  Status close();

 private:
  struct State;
  explicit VideoWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets
