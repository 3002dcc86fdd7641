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

/// One decoded picture.
struct VideoFrame {
  /// Presentation time from the start of the video, rounded to the nearest nanosecond.
  Duration time{};
  /// Shape: uint8 [H, W, 3], RGB.
  idf::NdArray image;
  /// The decoder had to guess parts of it.
  bool is_damaged = false;
};

class DecodedPicture;

/// One picture as the decoder gave it: neither converted nor scaled yet.
struct DecodedFrame {
  Duration time{};          ///< As that of VideoFrame.
  bool is_damaged = false;  ///< Likewise.
  std::shared_ptr<const DecodedPicture> picture;

  /// How much memory it holds.
  [[nodiscard]] size_t bytes() const;
  /// Whether it shows exactly what `other` does.
  [[nodiscard]] bool repeats(const DecodedFrame& other) const;
};

/// What the file says about its video before anything is decoded.
struct VideoInfo {
  int width = 0;                    ///< Unit: pixels, before cropping and scaling.
  int height = 0;                   ///< Unit: pixels, before cropping and scaling.
  std::string codec;                ///< "av1", "h264", ...
  double rate_hz = 0;               ///< On average; zero where unknown.
  uint64_t approximate_frames = 0;  ///< Zero where unknown.
  std::optional<Time> created;      ///< When the recording was made, if the file says so.
};

/// Decodes the first video stream of a file, in any codec that FFmpeg knows, AV1 included.
///
/// Frames come in the order of presentation, their times strictly increase. Colours follow the
/// matrix and range that the stream states; where it states none, BT.601 below 720 lines, else
/// BT.709, limited range. Rotation metadata is ignored. Memory: the decoder's own frames and one.
/// Threading: one thread that decodes, and one that converts; the decoder starts its own.
class VideoReader {
 public:
  struct Options {
    /// Size of the images. Zero: as the video, or what keeps its shape where the other is given.
    /// Shrinking averages areas, growing interpolates linearly. Unit: pixels.
    int width = 0;
    int height = 0;
    /// Cut out the centre square before scaling.
    bool crops_square = false;
    /// Threads of the decoder; each holds a frame or more in memory.
    int threads = 2;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kNotFound, kUnavailable where the file cannot be opened; kInvalidArgument where the
  /// options do not validate or the file holds no video that can be decoded.
  static Result<VideoReader> open(const std::filesystem::path& path, const Options& options);

  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;
  ~VideoReader();

  /// The next frame; nothing after the last.
  /// Errors: those of decode and convert.
  Result<std::optional<VideoFrame>> next();

  /// The next frame, for convert; most of the work where images are small is there.
  /// Errors: kDataLoss naming the file and the time reached where the stream breaks or ends before
  /// its announced length; the frames before that were all delivered.
  Result<std::optional<DecodedFrame>> decode();

  /// The image of a frame that this reader decoded.
  /// Errors: kInvalidArgument where its colours cannot be converted.
  Result<idf::NdArray> convert(const DecodedFrame& frame);

  /// Of all images: [H, W, 3].
  [[nodiscard]] idf::Shape image_shape() const;

  [[nodiscard]] const VideoInfo& info() const;

  /// Frames so far that could not be decoded, or only with guessed parts.
  [[nodiscard]] uint64_t damaged_frames() const;

 private:
  struct State;
  explicit VideoReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets
