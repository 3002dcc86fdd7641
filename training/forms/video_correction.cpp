// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_correction.h"

#include <utility>

#include "encoders/coded_background.h"
#include "encoders/coding/residual_image.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

bool is_of_8_bits(const idf::NdArray& image) {
  return image.type() == idf::ElementType::kUInt8 && image.shape().size() == 3;
}

encoders::PixelShape pixels_of(const idf::NdArray& image) {
  return encoders::FrameShape{image.type(), image.shape()}.pixels();
}

}  // namespace

Status apply_residuals(std::span<const std::byte> residual, std::span<idf::NdArray> images) {
  if (images.empty()) return {};
  if (!is_of_8_bits(images.front())) return data_loss("residuals of images that have no 8 bits");
  const encoders::PixelShape shape = pixels_of(images.front());
  ENGRAM_ASSIGN_OR_RETURN(
      const auto rows, encoders::decode_residuals(residual, shape, images.size(), images.size()));
  for (size_t i = 0; i < images.size(); ++i)
    if (!rows[i].empty()) images[i] = encoders::with_residual(images[i], rows[i], shape);
  return {};
}

Result<std::optional<VideoCorrection>> correct_video(std::span<const idf::NdArray> images,
                                                     std::span<const idf::NdArray> decoded,
                                                     double bound_db) {
  const std::optional<VideoCorrection> none;
  if (images.empty() || !is_of_8_bits(images.front())) return none;
  const encoders::PixelShape shape = pixels_of(images.front());
  encoders::ResidualEncoder encoder(shape);
  const auto max_error =
      static_cast<uint64_t>(mse_of_psnr(bound_db) * static_cast<double>(shape.count()));
  for (size_t i = 0; i < images.size(); ++i)
    if (!encoder.add(decoded[i].values<uint8_t>(), images[i].values<uint8_t>(), max_error))
      return none;
  VideoCorrection correction{encoder.finish(), {}};
  std::vector<idf::NdArray> corrected(decoded.begin(), decoded.end());
  if (!correction.residual.empty())
    ENGRAM_RETURN_IF_ERROR(apply_residuals(correction.residual, corrected));
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(correction.mse.emplace_back(), image_mse(images[i], corrected[i]));
    if (psnr_db(correction.mse.back()) < bound_db) return none;
  }
  return std::optional(std::move(correction));
}

}  // namespace engram::training
