// SPDX-License-Identifier: Apache-2.0
#include "encoders/moved_images.h"

#include "encoders/flow_extrapolation.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Shape: [C, H, W] -> [H, W, C]
idf::NdArray array_of(const Tensor& image) {
  const Tensor pixels =
      image.detach().permute({1, 2, 0}).round().clamp(0, 255).to(torch::kUInt8).contiguous();
  const auto* first = pixels.data_ptr<uint8_t>();
  return idf::NdArray::take<uint8_t>(pixels.sizes().vec(),
                                     std::vector<uint8_t>(first, first + pixels.numel()));
}

/// Shape: [H, W, C] -> [C, H, W]
Tensor tensor_of(const idf::NdArray& array) {
  return torch::from_blob(const_cast<std::byte*>(array.bytes().data()), array.shape(),
                          torch::kUInt8)
      .permute({2, 0, 1})
      .to(torch::kFloat32);
}

}  // namespace

Tensor moved_on(const Tensor& before, const Tensor& last, int steps) {
  std::vector<Tensor> rows;
  for (int64_t row = 0; row < last.size(0); ++row) {
    const auto images = flow_extrapolated(array_of(before[row]), array_of(last[row]), steps);
    std::vector<Tensor> moved(static_cast<size_t>(steps), last[row].detach());
    for (size_t step = 0; images.ok() && step < moved.size(); ++step)
      moved[step] = tensor_of((*images)[step]);
    rows.push_back(torch::stack(moved));
  }
  return torch::stack(rows);
}

}  // namespace engram::encoders
