// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "training/quality/psnr.h"

namespace engram::experiments {

/// Pictures of one camera. Shape of each: uint8 [H, W, 3].
struct Clip {
  std::string name;
  std::vector<idf::NdArray> images;
};

/// How a clip is made from videos.
struct ClipOptions {
  std::string name;
  /// Part of the path of its videos below the folder of recordings. All videos whose path contains
  /// it are joined.
  std::string file;
  bool crops_square = true;
  size_t stride = 0;  ///< Takes every stride-th frame; 0 takes five per second by their times.
  size_t max_frames = 100'000;
  int width = 128;  ///< Zero, like `height`: the size of the video.
  int height = 128;
};

/// Errors: kNotFound if there is no such file; those of reading a video.
Result<Clip> read_clip(const std::filesystem::path& folder, const ClipOptions& options);

/// The measurements of one codec on one clip.
struct CodecFigures {
  double bytes_per_frame = 0;
  training::PsnrStatistics psnr, moving;
  double ssim = 0;                      ///< The mean over all frames.
  double encode_ms = 0, decode_ms = 0;  ///< Wall time per frame.
};

/// Encodes a clip in groups of `group` frames (0: the whole clip in one) and decodes it.
/// `codec` is as for make_group_codec.
Result<CodecFigures> measure_codec(const Clip& clip, const std::string& codec, size_t group);

}  // namespace engram::experiments
