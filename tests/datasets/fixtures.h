// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/media/video_reader.h"
#include "datasets/media/video_writer.h"
#include "ltm/core/file.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::testing {

/// A scratch directory that files are written into by name.
class TemporaryDirectory : public ScratchDirectory {
 public:
  /// Writes a file and says where it is.
  std::filesystem::path write(std::string_view name, std::string_view content) const {
    std::ofstream(path() / name, std::ios::binary) << content;
    return path() / name;
  }
};

inline std::string content_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  ENGRAM_CHECK(bytes.ok(), "{}", bytes.status().to_string());
  return std::string(as_text(bytes->bytes()));
}

/// Where recordings for tests lie; empty where there are none.
inline std::filesystem::path recordings() {
  const char* stated = std::getenv("ENGRAM_RECORDINGS");
  const std::filesystem::path path =
      stated != nullptr ? std::filesystem::path(stated)
                        : std::filesystem::path(ENGRAM_SOURCE_DIR) / "../shared/data";
  return std::filesystem::exists(path / "g1") ? path : std::filesystem::path();
}

/// A smooth, colourful image that drifts with `step`.
inline idf::NdArray smooth_image(int width, int height, int step) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const double phase : {0.0, 2.0, 4.0})
        pixels.push_back(
            static_cast<uint8_t>(std::lround(128 + 60 * std::sin(0.05 * (x + 2 * step) + phase) +
                                             50 * std::cos(0.04 * (y - step) + 1.5 * phase))));
  return idf::NdArray::take({height, width, 3}, std::move(pixels));
}

inline double psnr_db(const idf::NdArray& a, const idf::NdArray& b) {
  ENGRAM_CHECK(a.shape() == b.shape(), "{} against {}", idf::to_string(a.shape()),
               idf::to_string(b.shape()));
  double sum = 0;
  for (size_t i = 0; i < a.values<uint8_t>().size(); ++i) {
    const double error = a.values<uint8_t>()[i] - b.values<uint8_t>()[i];
    sum += error * error;
  }
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.count()) / std::max(sum, 1e-9));
}

/// Writes a video of `count` smooth images.
inline Status write_video(const std::filesystem::path& path, int count,
                          const VideoWriter::Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(VideoWriter writer, VideoWriter::create(path, options));
  for (int i = 0; i < count; ++i)
    ENGRAM_RETURN_IF_ERROR(writer.write(smooth_image(options.width, options.height, i)));
  return writer.close();
}

/// All frames up to the end or the first error.
struct Frames {
  std::vector<VideoFrame> frames;
  Status status;
};

inline Frames read_all(VideoReader& reader) {
  Frames result;
  while (true) {
    auto frame = reader.next();
    if (!frame.ok()) {
      result.status = frame.status();
      return result;
    }
    if (!*frame) return result;
    result.frames.push_back(**std::move(frame));
  }
}

}  // namespace engram::datasets::testing
