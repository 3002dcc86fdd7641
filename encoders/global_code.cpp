// SPDX-License-Identifier: Apache-2.0
#include "encoders/global_code.h"

#include <algorithm>

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Max number of cells along a side of a grid.
constexpr int64_t kCells = 4;

}  // namespace

Tensor pooled_latents(const Latents& latents) {
  std::vector<Tensor> means;
  for (const ImageLatents& image : latents.images) {
    const Tensor& z = image.coarse;
    const Tensor cells =
        torch::adaptive_avg_pool2d(z, {std::min(kCells, z.size(2)), std::min(kCells, z.size(3))});
    means.push_back(cells.contiguous().flatten(1));
  }
  return torch::cat(means, 1);  // [B, F]
}

int64_t pooled_size(const NetworkShape& shape) {
  int64_t size = 0;
  for (size_t i = 0; i < shape.images.size() && shape.sizes.width > 0; ++i) {
    const LatentGrid coarse = shape.grids(i).front();
    size += int64_t{coarse.channels} * std::min<int64_t>(kCells, coarse.height) *
            std::min<int64_t>(kCells, coarse.width);
  }
  return size;
}

Tensor GlobalCode::of(const Latents& latents) const {
  return torch::matmul(pooled_latents(latents), projection.t()) +
         offset.index_select(0, latents.scene);
}

}  // namespace engram::encoders
