// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "encoders/model_records.h"
#include "encoders/model_vectors.h"
#include "encoders/stored_tensors.h"
#include "encoders/weight_rounding.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr const char* kGroup = "/global_code";

template <typename T>
Result<std::vector<T>> read_exactly(const h5::File& file, const std::string& name, int64_t count) {
  ENGRAM_ASSIGN_OR_RETURN(auto values, read_vector<T>(file, std::string(kGroup) + name));
  if (values.size() != static_cast<size_t>(count))
    return data_loss("global code: found {} numbers in '{}', needs {}", values.size(), name, count);
  return values;
}

}  // namespace

Status write_global_code(h5::File& file, const GlobalCode& code) {
  if (!code.is_known()) return {};
  const int64_t features = code.projection.size(1);
  std::vector<float> scales;
  std::vector<int8_t> bytes;
  for (int64_t row = 0; row < kGlobalCodeSize; ++row) {
    const std::vector<float> weights = floats_of(code.projection.select(0, row));
    float largest = 0;
    for (const float weight : weights) largest = std::max(largest, std::abs(weight));
    scales.push_back(weight_scale(largest));
    for (const float weight : weights)
      bytes.push_back(static_cast<int8_t>(std::lround(weight / scales.back())));
  }
  ENGRAM_CHECK(static_cast<int64_t>(bytes.size()) == kGlobalCodeSize * features,
               "{} weights of {} numbers", bytes.size(), kGlobalCodeSize);
  const std::string group = kGroup;
  ENGRAM_RETURN_IF_ERROR(write_vector(file, group + "/bytes", bytes));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, group + "/scales", scales));
  return write_vector(file, group + "/offset", floats_of(code.offset));
}

Result<GlobalCode> read_global_code(const h5::File& file, const NetworkShape& shape) {
  ENGRAM_ASSIGN_OR_RETURN(const bool is_there, file.exists(kGroup));
  if (!is_there || shape.images.empty() || shape.sizes.width == 0) return GlobalCode();
  const int64_t features = pooled_size(shape);
  const int64_t scenes = shape.sizes.scenes;
  ENGRAM_ASSIGN_OR_RETURN(const auto bytes,
                          read_exactly<int8_t>(file, "/bytes", kGlobalCodeSize * features));
  ENGRAM_ASSIGN_OR_RETURN(const auto scales, read_exactly<float>(file, "/scales", kGlobalCodeSize));
  ENGRAM_ASSIGN_OR_RETURN(const auto offset,
                          read_exactly<float>(file, "/offset", kGlobalCodeSize * scenes));
  const auto is_finite = [](float value) { return std::isfinite(value); };
  if (!std::ranges::all_of(scales, is_finite) || !std::ranges::all_of(offset, is_finite))
    return data_loss("global code: found a weight that is not finite");
  const std::vector<float> weights(bytes.begin(), bytes.end());
  return GlobalCode{torch::tensor(weights).reshape({kGlobalCodeSize, features}) *
                        torch::tensor(scales).unsqueeze(1),
                    torch::tensor(offset).reshape({scenes, kGlobalCodeSize})};
}

}  // namespace engram::encoders
