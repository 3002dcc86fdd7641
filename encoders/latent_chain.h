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
#include "encoders/packed_video.h"
#include "ltm/idf/ndarray.h"

namespace engram::encoders {

/// One image member over the rows of a chain.
struct ImageRows {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;       ///< Whether the latents were refined after encoding.
  std::vector<int32_t> latents;  ///< [rows, latents]; empty in other forms.
  /// Code of all rows by ResidualEncoder; empty if the latents or the video keep the bound alone.
  std::vector<std::byte> residual;
  ResidualRows residuals;            ///< Decoded from `residual`; not needed to encode.
  std::vector<std::byte> video;      ///< Code of all rows in another form than latents.
  std::vector<idf::NdArray> frames;  ///< Decoded from `video`; not needed to encode.

  friend bool operator==(const ImageRows&, const ImageRows&) = default;
};

/// The data from which the images and numbers of consecutive snapshots are decoded.
struct LatentRows {
  /// Index of the background, or of the one most similar to the block's own.
  uint32_t scene = 0;
  /// Backgrounds that the block carries, per image member, or empty.
  std::vector<CodedBackground> own;
  std::vector<ImageRows> images;  ///< Per image member.
  std::vector<double> numbers;    ///< [rows, N].
};

/// The form and size of one image member in a chain.
struct ImageCode {
  ImageForm form = ImageForm::kLatents;
  bool is_refined = false;
  uint64_t bytes = 0;                   ///< Of all rows, without residuals.
  std::span<const std::byte> code;      ///< These bytes, of the chain that was described.
  std::span<const std::byte> residual;  ///< The same of the residuals.
  /// Size of the residual of each row, if it has one. The vector is empty if no row has one.
  std::vector<std::optional<uint64_t>> residual_bytes;
};

/// Reads the head of a chain of `count` rows and `images` image members, without its model.
/// Errors: kDataLoss.
Result<std::vector<ImageCode>> describe_chain(std::span<const std::byte> chain, size_t count,
                                              size_t images);

/// Codes consecutive rows as a chain. Each row is coded from the rows before it, so decoding starts
/// at the first one.
///
/// Format: for each image member varints of its form (plus 8 if latents were refined, plus 16 if
/// residuals follow), of the size of its code and of the size of its residuals, if any; then these
/// codes in the same order; then the code of the numbers.
/// Threading: const-parallel.
struct LatentChainCodec {
  std::vector<FrameShape> frames;           ///< Per image member.
  std::vector<LatentSequenceCodec> images;  ///< Per image member; empty if all are videos or gists.
  std::optional<NumberCodec> numbers;
  /// What packed videos begin from, per image member; empty if none do.
  std::vector<std::vector<VideoReference>> references{};

  /// The references of an image member.
  [[nodiscard]] std::span<const VideoReference> references_of(size_t image) const {
    return image < references.size() ? std::span(references[image])
                                     : std::span<const VideoReference>();
  }

  /// Encodes `count` rows, which `rows` has of every member (checked). The chain does not contain
  /// the scene and the backgrounds.
  [[nodiscard]] std::vector<std::byte> encode(const LatentRows& rows, size_t count) const;

  /// Decodes the first `wanted` of `count` rows. It is safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition if the decoder of a video is not installed.
  Result<LatentRows> decode(std::span<const std::byte> chain, size_t count, size_t wanted) const;

 private:
  Status decode_image(size_t image, std::span<const std::byte> bytes, size_t count, size_t wanted,
                      ImageRows& rows) const;
  Status decode_residual(size_t image, std::span<const std::byte> bytes, size_t count,
                         size_t wanted, ImageRows& rows) const;
};

}  // namespace engram::encoders
