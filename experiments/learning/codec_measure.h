// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "training/quality/psnr.h"

namespace engram::experiments {

/// Pictures of one camera. Shape: each uint8 [128, 128, 3].
struct Clip {
  std::string name;
  std::vector<idf::NdArray> images;
};

/// How a clip is made of a video.
struct ClipOptions {
  std::string name;
  /// Part of the path of its videos below the folder of recordings; all that have it, in a row.
  std::string file;
  bool crops_square = true;
  size_t stride = 0;  ///< Every so many frames; 0: five a second by their times.
  size_t max_frames = 100'000;
};

/// Errors: kNotFound where there is no such file; those of reading a video.
Result<Clip> read_clip(const std::filesystem::path& folder, const ClipOptions& options);

/// What a codec made of a clip.
struct CodecFigures {
  double bytes_per_frame = 0;
  training::PsnrStatistics psnr, moving;
  double ssim = 0;                      ///< Mean.
  double encode_ms = 0, decode_ms = 0;  ///< Per frame, wall time.
};

/// Codes a clip in groups of `group` frames (0: all of it in one) and decodes it again.
/// `codec` as make_group_codec takes it.
Result<CodecFigures> measure_codec(const Clip& clip, const std::string& codec, size_t group);

}  // namespace engram::experiments
