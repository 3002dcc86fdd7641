// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "encoders/coded_background.h"
#include "encoders/coding/latent_sequence.h"
#include "encoders/coding/number_codec.h"
#include "encoders/coding/residual_image.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// One image member over the rows of a chain.
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

/// How one image member is kept in a chain.
struct ImageCode {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;
  uint64_t bytes = 0;  ///< Of all rows together, without residuals.
  /// Of each row; nothing where it has none. Empty where no row has one.
  std::vector<std::optional<uint64_t>> residual_bytes;
};

/// What a chain of `count` rows and `images` image members says of itself, without its model.
/// Errors: kDataLoss.
Result<std::vector<ImageCode>> describe_chain(std::span<const std::byte> chain, size_t count,
                                              size_t images);

/// Codes consecutive rows as a chain, each from those before it: decoding starts at the first.
///
/// Format: as varints, of each image member its form (plus 8 where latents were refined, plus 16
/// where residuals follow), the size of its code and, where they follow, of its residuals; what was
/// so announced, in this order; and the code of the numbers.
/// Threading: const-parallel.
struct LatentChainCodec {
  std::vector<FrameShape> frames;           ///< Per image member.
  std::vector<LatentSequenceCodec> images;  ///< Per image member, or none: then all are videos.
  std::optional<NumberCodec> numbers;

  /// `rows` hold `count` rows of every member (checked). Scene and backgrounds are not part of it.
  [[nodiscard]] std::vector<std::byte> encode(const LatentRows& rows, size_t count) const;

  /// The first `wanted` of the `count` rows; videos are decoded whole, residuals as far as latents.
  /// Safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition where a video's decoder is not installed.
  Result<LatentRows> decode(std::span<const std::byte> chain, size_t count, size_t wanted) const;

 private:
  Status decode_image(size_t image, std::span<const std::byte> bytes, size_t count, size_t wanted,
                      ImageRows& rows) const;
  Status decode_residual(size_t image, std::span<const std::byte> bytes, size_t count,
                         size_t wanted, ImageRows& rows) const;
};

}  // namespace engram::encoders
