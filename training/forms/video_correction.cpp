// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_correction.h"

#include <cmath>
#include <utility>

#include "encoders/coding/residual_image.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

std::optional<encoders::PixelShape> pixels_of(const idf::NdArray& image) {
  if (image.type() != idf::ElementType::kUInt8 || image.shape().size() != 3) return std::nullopt;
  const idf::Shape& shape = image.shape();
  return encoders::PixelShape{static_cast<int>(shape[0]), static_cast<int>(shape[1]),
                              static_cast<int>(shape[2])};
}

/// The error that an image of so many numbers may have. Unit: grey levels squared, over all.
uint64_t max_error(double bound_db, size_t numbers) {
  return static_cast<uint64_t>(255.0 * 255.0 * std::pow(10.0, -bound_db / 10.0) *
                               static_cast<double>(numbers));
}

}  // namespace

Status apply_residuals(std::span<const std::byte> residual, std::span<idf::NdArray> images) {
  if (images.empty()) return {};
  const auto shape = pixels_of(images.front());
  if (!shape) return data_loss("residuals of images that have no 8 bits");
  ENGRAM_ASSIGN_OR_RETURN(
      const auto rows, encoders::decode_residuals(residual, *shape, images.size(), images.size()));
  for (size_t i = 0; i < images.size(); ++i) {
    if (rows[i].empty()) continue;
    const auto values = images[i].values<uint8_t>();
    std::vector<uint8_t> pixels(values.begin(), values.end());
    encoders::add_residual(rows[i], *shape, pixels);
    images[i] = idf::NdArray::take<uint8_t>(images[i].shape(), std::move(pixels));
  }
  return {};
}

Result<std::optional<VideoCorrection>> correct_video(std::span<const idf::NdArray> images,
                                                     std::span<const idf::NdArray> decoded,
                                                     double bound_db) {
  const std::optional<VideoCorrection> none;
  const auto shape = images.empty() ? std::nullopt : pixels_of(images.front());
  if (!shape) return none;
  encoders::ResidualEncoder encoder(*shape);
  const uint64_t error = max_error(bound_db, shape->count());
  for (size_t i = 0; i < images.size(); ++i)
    if (!encoder.add(decoded[i].values<uint8_t>(), images[i].values<uint8_t>(), error)) return none;
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
