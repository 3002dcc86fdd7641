// SPDX-License-Identifier: Apache-2.0
#include "encoders/stored_tensors.h"

#include <algorithm>
#include <cmath>

namespace engram::encoders {

std::vector<float> floats_of(const torch::Tensor& tensor) {
  const torch::Tensor rows = tensor.detach().to(torch::kFloat).contiguous().flatten();
  return {rows.data_ptr<float>(), rows.data_ptr<float>() + rows.numel()};
}

Status write_tensors(h5::File& file, const char* array, const std::vector<torch::Tensor>& tensors) {
  std::vector<float> numbers;
  for (const torch::Tensor& tensor : tensors) {
    const std::vector<float> more = floats_of(tensor);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  const uint64_t count = numbers.size();
  return file.write(array, h5::Type::kFloat32, std::span(&count, 1),
                    std::as_bytes(std::span(numbers)), h5::Storage::kCompressed);
}

Status read_tensors(const h5::File& file, const std::filesystem::path& path, const char* array,
                    std::vector<torch::Tensor>& tensors) {
  size_t needed = 0;
  for (const torch::Tensor& tensor : tensors) needed += static_cast<size_t>(tensor.numel());
  // A file that has more is refused before its numbers take memory.
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes,
                          file.read(array, h5::Type::kFloat32, (needed + 1) * sizeof(float)));
  const auto numbers = h5::as_vector<float>(bytes);
  if (numbers.size() != needed)
    return data_loss("'{}': found {} weights, needs {}", path.string(), numbers.size(), needed);
  if (!std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); }))
    return data_loss("'{}': found a weight that is no number", path.string());
  torch::NoGradGuard no_gradient;
  const float* from = numbers.data();
  for (torch::Tensor& tensor : tensors) {
    tensor.copy_(torch::from_blob(const_cast<float*>(from), tensor.sizes(), torch::kFloat));
    from += tensor.numel();
  }
  return {};
}

}  // namespace engram::encoders
