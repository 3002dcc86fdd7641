// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "encoders/coded_background.h"
#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// How much of images a gist keeps.
struct GistOptions {
  /// Quality of the AV1 video of the kept images: 0 (best) to 63.
  int crf = 60;
  /// Effort of the AV1 encoder: 0 (fast) to 9. One more takes 2 to 3 times as long.
  int effort = 7;
  /// An image is kept if that raises the sum of the PSNR of all images by this. Fewer images are
  /// kept, and fewer bytes taken, where it is larger. Unit: dB.
  double gain_db = 3;
  /// Maximum distance of kept images. 1 keeps all of them.
  size_t max_gap = 24;

  /// Errors: kInvalidArgument.
  [[nodiscard]] Status validate() const;
};

/// Whether encode_gist takes images of this type and shape.
[[nodiscard]] bool can_be_gist(const FrameShape& frame);

/// Codes images in the order of time as their gist: what was roughly there, in few bytes.
///
/// The gist is an AV1 video of the images between which a linear interpolation in time tells the
/// others best. Images whose longer side has more than 160 pixels are made smaller by a whole
/// factor. A key frame costs as much as 20 to 50 other images, so chains should be long: as many
/// images as a block may have are good.
///
/// Shape: uint8 [H, W, 1] or [H, W, 3], all alike, H and W of 16 at least, H * W of
/// 2^26 at most; 1 to ltm::kMaxGroupImages of them.
/// Errors: kInvalidArgument; kFailedPrecondition if the encoder is not installed.
/// Threading: const-parallel.
/// Source: docs/learning_methods.md, section "Gists".
Result<std::vector<std::byte>> encode_gist(std::span<const idf::NdArray> images,
                                           const GistOptions& options);

/// The rows of a gist of `count` images that are kept; the others are told from the two beside
/// them. It is safe on hostile bytes. Errors: kDataLoss.
Result<std::vector<size_t>> kept_rows_of_gist(std::span<const std::byte> gist,
                                              const FrameShape& frame, size_t count);

/// Decodes the first `wanted` of `count` images, at most all (checked). Kept images after the first
/// one that they need are not decoded, and damage there is not found. The images are the same on
/// every machine. It is safe on hostile bytes, but most flipped bits give other images: the bytes
/// need a checksum around them, as blocks have.
/// Errors: kDataLoss; kFailedPrecondition if the decoder is not installed.
/// Threading: const-parallel.
Result<std::vector<idf::NdArray>> decode_gist(std::span<const std::byte> gist,
                                              const FrameShape& frame, size_t count, size_t wanted);

}  // namespace engram::encoders
