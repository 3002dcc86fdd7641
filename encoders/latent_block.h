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
#include "encoders/coding/residual_image.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// One image member over the rows of a block.
struct ImageRows {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;           ///< Whether latents are not as the encoder made them.
  std::vector<int32_t> latents;      ///< [rows, latents]; empty in other forms.
  std::vector<std::byte> residual;   ///< What ResidualEncoder made of all rows; empty: they are
                                     ///< good as latents alone.
  ResidualRows residuals;            ///< Decoded from `residual`; not needed to encode.
  std::vector<std::byte> video;      ///< What the codec of the form made of all rows.
  std::vector<idf::NdArray> frames;  ///< Decoded from `video`; not needed to encode.

  friend bool operator==(const ImageRows&, const ImageRows&) = default;
};

/// What the images and numbers of consecutive snapshots are decoded from.
struct LatentRows {
  uint32_t scene = 0;                ///< Which background, or the one most like the block's own.
  std::vector<CodedBackground> own;  ///< Backgrounds of the block itself, per image; or none.
  std::vector<ImageRows> images;     ///< Per image member.
  std::vector<double> numbers;       ///< [rows, N].
};

/// How one image member is kept in a block.
struct ImageCode {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;
  uint64_t bytes = 0;             ///< Of all rows together, without residuals and background.
  uint64_t background_bytes = 0;  ///< Of the block's own background; 0: it has none.
  /// Of each row; nothing where it has none. Empty where no row has one.
  std::vector<std::optional<uint64_t>> residual_bytes;
};

/// What a block of `count` rows and `images` image members says of itself, without its model.
/// Errors: kDataLoss.
Result<std::vector<ImageCode>> describe_block(std::span<const std::byte> block, size_t count,
                                              size_t images);

/// Codes rows as one block, which decodes alone.
///
/// Format: twice the scene, plus one where the block has backgrounds of its own; then, as varints,
/// form and size of those; of each image member its form (plus 8 where latents were refined, plus
/// 16 where residuals follow), the size of its code and, where they follow, of its residuals; what
/// was so announced, in this order; the code of the numbers; and a checksum of 32 bits over all,
/// which also covers the number of rows.
/// Threading: const-parallel.
struct LatentBlockCodec {
  std::vector<FrameShape> frames;           ///< Per image member.
  std::vector<LatentSequenceCodec> images;  ///< Per image member, or none: then all are videos.
  std::optional<NumberCodec> numbers;
  uint32_t scenes = 1;

  /// `rows` hold `count` rows of every member (checked).
  [[nodiscard]] std::vector<std::byte> encode(const LatentRows& rows, size_t count) const;

  /// The first `wanted` of the `count` rows of a block; videos are decoded whole, residuals as far
  /// as latents. Safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition where a video's decoder is not installed.
  Result<LatentRows> decode(std::span<const std::byte> block, size_t count, size_t wanted) const;

 private:
  Status decode_image(size_t image, std::span<const std::byte> bytes, size_t count, size_t wanted,
                      ImageRows& rows) const;
  Status decode_residual(size_t image, std::span<const std::byte> bytes, size_t count,
                         size_t wanted, ImageRows& rows) const;
};

}  // namespace engram::encoders
