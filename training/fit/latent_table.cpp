// SPDX-License-Identifier: Apache-2.0
#include "training/fit/latent_table.h"

#include <algorithm>

namespace engram::training {

using torch::Tensor;

namespace {

Tensor narrowed(const Tensor& z) {
  return z.clamp(-32767, 32767).to(torch::kInt16);
}

Tensor widened(const Tensor& z, const Tensor& indices) {
  return z.index_select(0, indices).to(torch::kFloat32).contiguous(at::MemoryFormat::ChannelsLast);
}

}  // namespace

encoders::Latents LatentTable::rows(const Tensor& indices) const {
  encoders::Latents latents{{}, {}, scene.index_select(0, indices)};
  for (const auto& image : images)
    latents.images.push_back({widened(image.coarse, indices), widened(image.fine, indices)});
  if (numbers.defined()) latents.numbers = numbers.index_select(0, indices);
  return latents;
}

LatentTable encode_all(encoders::DeepModel& model, const Dataset& data) {
  // Bounds the memory of activations: of images of 640 x 480, one at a time.
  constexpr int64_t kTogetherPixels = 16 * 128 * 128;
  torch::NoGradGuard no_grad;
  const size_t images = model.autoencoder->images.size();
  int64_t pixels = 1;
  for (const auto& image : model.autoencoder->shape.images)
    pixels = std::max(pixels, int64_t{image.height} * image.width);
  const int64_t together = std::clamp<int64_t>(kTogetherPixels / pixels, 1, 16);
  std::vector<std::vector<Tensor>> coarse(images), fine(images);
  const auto rows = static_cast<int64_t>(images == 0 ? 0 : data.size());
  for (int64_t first = 0; first < rows; first += together) {
    const Tensor indices = torch::arange(first, std::min(first + together, rows), torch::kLong);
    const auto z =
        encoders::round(model.autoencoder->encode(data.batch(model.autoencoder->shape, indices)));
    for (size_t i = 0; i < z.images.size(); ++i) {
      coarse[i].push_back(narrowed(z.images[i].coarse));
      fine[i].push_back(narrowed(z.images[i].fine));
    }
  }
  LatentTable table{{}, data.numbers, data.scene};
  for (size_t i = 0; i < coarse.size(); ++i)
    table.images.push_back({torch::cat(coarse[i]).contiguous(), torch::cat(fine[i]).contiguous()});
  return table;
}

}  // namespace engram::training
