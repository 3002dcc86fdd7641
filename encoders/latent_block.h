// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "encoders/coded_background.h"
#include "encoders/coding/latent_sequence.h"
#include "encoders/coding/number_codec.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// One image member over the rows of a block.
struct ImageRows {
  ImageForm form = ImageForm::kLatents;
  std::vector<int32_t> latents;      ///< [rows, latents]; empty in other forms.
  std::vector<std::byte> video;      ///< What the codec of the form made of all rows.
  std::vector<idf::NdArray> frames;  ///< Decoded from `video`; not needed to encode.

  friend bool operator==(const ImageRows&, const ImageRows&) = default;
};

/// What the images and numbers of consecutive snapshots are decoded from.
struct LatentRows {
  uint32_t scene = 0;  ///< Which background, or the one most like that of the block.
  std::vector<CodedBackground>
      own;                        ///< Backgrounds of the block itself, per image member; or none.
  std::vector<ImageRows> images;  ///< Per image member.
  std::vector<double> numbers;    ///< [rows, N].
};

/// Codes rows as one block, which decodes alone.
///
/// Format: twice the scene, plus one where the block has backgrounds of its own; form and size of
/// those, then of each image member's code, all as varints; what was so announced; the code of the
/// numbers; and a checksum of 32 bits over all, which also covers the number of rows.
/// Threading: const-parallel.
struct LatentBlockCodec {
  std::vector<FrameShape> frames;           ///< Per image member.
  std::vector<LatentSequenceCodec> images;  ///< Per image member, or none: then all are videos.
  std::optional<NumberCodec> numbers;
  uint32_t scenes = 1;

  /// `rows` hold `count` rows of every member (checked).
  [[nodiscard]] std::vector<std::byte> encode(const LatentRows& rows, size_t count) const;

  /// The first `wanted` of the `count` rows of a block; videos are decoded whole. Safe on hostile
  /// bytes.
  /// Errors: kDataLoss; kFailedPrecondition where a video's decoder is not installed.
  Result<LatentRows> decode(std::span<const std::byte> block, size_t count, size_t wanted) const;

 private:
  Status decode_image(size_t image, std::span<const std::byte> bytes, size_t count, size_t wanted,
                      ImageRows& rows) const;
};

}  // namespace engram::encoders
