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
  /// True if the decoder had to guess parts of the picture.
  bool is_damaged = false;
};

class DecodedPicture;

/// One picture in the format of the decoder, neither converted nor scaled.
struct DecodedFrame {
  Duration time{};          ///< As VideoFrame::time.
  bool is_damaged = false;  ///< As VideoFrame::is_damaged.
  std::shared_ptr<const DecodedPicture> picture;

  /// The memory that the picture holds.
  [[nodiscard]] size_t bytes() const;
  /// Returns true if it shows exactly the same picture as `other`.
  [[nodiscard]] bool repeats(const DecodedFrame& other) const;
};

/// What the file says about its video before anything is decoded.
struct VideoInfo {
  int width = 0;                    ///< Before cropping and scaling. Unit: pixels.
  int height = 0;                   ///< Before cropping and scaling. Unit: pixels.
  std::string codec;                ///< "av1", "h264", ...
  double rate_hz = 0;               ///< The average rate; zero if unknown.
  uint64_t approximate_frames = 0;  ///< Zero if unknown.
  std::optional<Time> created;      ///< When the recording was made, if the file says so.
};

/// Decodes the first video stream of a file, in any codec that FFmpeg supports, including AV1.
///
/// Frames come in the order of presentation, and their times strictly increase. Colours follow the
/// matrix and range that the stream states. If it states none, they are in the limited range of
/// BT.601 below 720 lines, else of BT.709. Rotation metadata is ignored. Memory: the decoder's own
/// frames and one more.
/// Threading: one thread that decodes, and one that converts; the decoder starts its own threads.
class VideoReader {
 public:
  struct Options {
    /// Size of the images. If both are zero, the size of the video; if one is zero, it follows from
    /// the other and the aspect ratio. Shrinking averages areas, growing interpolates linearly.
    /// Unit: pixels.
    int width = 0;
    int height = 0;
    /// Crop to the central square before scaling.
    bool crops_square = false;
    /// Threads of the decoder; each holds at least one frame in memory.
    int threads = 2;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kNotFound, kUnavailable if the file cannot be opened; kInvalidArgument if the options
  /// do not validate or the file has no video that can be decoded.
  static Result<VideoReader> open(const std::filesystem::path& path, const Options& options);

  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;
  ~VideoReader();

  /// Returns the next frame; nothing after the last one.
  /// Errors: those of decode and convert.
  Result<std::optional<VideoFrame>> next();

  /// Returns the next frame for convert(), which is most of the work if images are small.
  /// Errors: kDataLoss naming the file and the time reached if the stream breaks or ends before its
  /// announced length; all frames before that were delivered.
  Result<std::optional<DecodedFrame>> decode();

  /// Makes the image of a frame that this reader decoded.
  /// Errors: kInvalidArgument if its colours cannot be converted.
  Result<idf::NdArray> convert(const DecodedFrame& frame);

  /// The shape of all images: [H, W, 3].
  [[nodiscard]] idf::Shape image_shape() const;

  [[nodiscard]] const VideoInfo& info() const;

  /// The number of frames so far that could not be decoded, or only with guessed parts.
  [[nodiscard]] uint64_t damaged_frames() const;

 private:
  struct State;
  explicit VideoReader(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets
