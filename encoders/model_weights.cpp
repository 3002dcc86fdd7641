// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_weights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "encoders/coded_weights.h"
#include "encoders/layers.h"
#include "encoders/model_vectors.h"
#include "encoders/weight_rounding.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Weights of a module, grouped by the way in which they are stored, in the order in which the
/// module registers them. Names are not stored.
struct Weights {
  std::vector<int8_t> bytes;    ///< Matrices and convolutions.
  std::vector<float> scales;    ///< One per output channel of those.
  std::vector<uint8_t> pixels;  ///< Backgrounds.
  std::vector<float> floats;    ///< Everything else.
};

/// Calls visit(name, tensor, is_buffer) for all tensors of both networks.
template <typename Visit>
Status for_each_tensor(DeepModel& model, Visit visit) {
  for (torch::nn::Module* module : {static_cast<torch::nn::Module*>(model.autoencoder.get()),
                                    static_cast<torch::nn::Module*>(model.dynamics.get())}) {
    for (auto& item : module->named_parameters())
      ENGRAM_RETURN_IF_ERROR(visit(item.key(), item.value(), false));
    for (auto& item : module->named_buffers())
      ENGRAM_RETURN_IF_ERROR(visit(item.key(), item.value(), true));
  }
  return {};
}

void append_bytes(const Tensor& tensor, Weights& weights) {
  const std::vector<float> values = floats_of(tensor);
  const size_t row_size = values.size() / static_cast<size_t>(tensor.size(0));
  for (size_t first = 0; first < values.size(); first += row_size) {
    float largest = 0;
    for (size_t i = 0; i < row_size; ++i) largest = std::max(largest, std::abs(values[first + i]));
    const float scale = weight_scale(largest);
    weights.scales.push_back(scale);
    for (size_t i = 0; i < row_size; ++i)
      weights.bytes.push_back(static_cast<int8_t>(std::lround(values[first + i] / scale)));
  }
}

Weights collect(DeepModel& model) {
  torch::NoGradGuard no_grad;
  Weights weights;
  const Status status =
      for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) {
        switch (kept_as(name, tensor, is_buffer)) {
          case Kept::kBytes:
            append_bytes(tensor, weights);
            break;
          case Kept::kPixels:
            for (const float value : floats_of(tensor))
              weights.pixels.push_back(static_cast<uint8_t>(std::lround(value * kGreyLevels)));
            break;
          case Kept::kFloats:
            for (const float value : floats_of(tensor)) weights.floats.push_back(value);
            break;
        }
        return Status();
      });
  ENGRAM_CHECK(status.ok(), "{}", status.message());
  return weights;
}

/// Takes the next values of each kind and checks that there are enough of them.
class WeightReader {
 public:
  explicit WeightReader(const Weights& weights) : weights_(weights) {}

  Status read(const std::string& name, Tensor& tensor, bool is_buffer) {
    const auto count = static_cast<size_t>(tensor.numel());
    std::vector<float> values(count);
    switch (kept_as(name, tensor, is_buffer)) {
      case Kept::kBytes: {
        const auto rows = static_cast<size_t>(tensor.size(0));
        if (weights_.bytes.size() - bytes_ < count || weights_.scales.size() - scales_ < rows)
          return too_few(name);
        for (size_t i = 0; i < count; ++i)
          values[i] = static_cast<float>(weights_.bytes[bytes_ + i]) *
                      weights_.scales[scales_ + i / (count / rows)];
        bytes_ += count;
        scales_ += rows;
        break;
      }
      case Kept::kPixels:
        if (weights_.pixels.size() - pixels_ < count) return too_few(name);
        for (size_t i = 0; i < count; ++i)
          values[i] = static_cast<float>(weights_.pixels[pixels_ + i] / kGreyLevels);
        pixels_ += count;
        break;
      case Kept::kFloats:
        if (weights_.floats.size() - floats_ < count) return too_few(name);
        std::copy_n(weights_.floats.begin() + static_cast<std::ptrdiff_t>(floats_), count,
                    values.begin());
        floats_ += count;
        break;
    }
    tensor.copy_(torch::tensor(values).reshape(tensor.sizes()));
    return {};
  }

  [[nodiscard]] bool is_at_end() const {
    return bytes_ == weights_.bytes.size() && scales_ == weights_.scales.size() &&
           pixels_ == weights_.pixels.size() && floats_ == weights_.floats.size();
  }

 private:
  static Status too_few(const std::string& name) {
    return data_loss("found too few weights for '{}'", name);
  }

  const Weights& weights_;
  size_t bytes_ = 0, scales_ = 0, pixels_ = 0, floats_ = 0;
};

/// The tensors that are kept in one way, sorted by name.
std::vector<std::pair<std::string, Tensor>> tensors_kept(DeepModel& model, Kept kept) {
  std::vector<std::pair<std::string, Tensor>> tensors;
  const Status status =
      for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) {
        if (tensor.numel() > 0 && kept_as(name, tensor, is_buffer) == kept)
          tensors.emplace_back(name, tensor);
        return Status();
      });
  ENGRAM_CHECK(status.ok(), "{}", status.message());
  return tensors;
}

std::vector<MatrixShape> matrices_of(DeepModel& model) {
  std::vector<MatrixShape> shapes;
  for (const auto& [name, tensor] : tensors_kept(model, Kept::kBytes)) {
    const auto rows = static_cast<size_t>(tensor.size(0));
    shapes.push_back({name, rows, static_cast<size_t>(tensor.numel()) / rows});
  }
  return shapes;
}

std::vector<ScenesShape> backgrounds_of(DeepModel& model) {
  std::vector<ScenesShape> shapes;
  for (const auto& [name, tensor] : tensors_kept(model, Kept::kPixels))
    shapes.push_back({name,
                      static_cast<size_t>(tensor.size(0)),
                      {static_cast<int>(tensor.size(1)), static_cast<int>(tensor.size(2)),
                       static_cast<int>(tensor.size(3))}});
  return shapes;
}

}  // namespace

Status write_weights(h5::File& file, DeepModel& model) {
  const Weights weights = collect(model);
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/scales", weights.scales));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/floats", weights.floats));
  ENGRAM_RETURN_IF_ERROR(write_matrices(file, matrices_of(model), weights.bytes));
  return write_backgrounds(file, backgrounds_of(model), weights.pixels);
}

Status read_weights(const h5::File& file, DeepModel& model) {
  Weights weights;
  ENGRAM_ASSIGN_OR_RETURN(weights.bytes, read_matrices(file, matrices_of(model)));
  ENGRAM_ASSIGN_OR_RETURN(weights.pixels, read_backgrounds(file, backgrounds_of(model)));
  ENGRAM_ASSIGN_OR_RETURN(weights.scales, read_vector<float>(file, "/weights/scales"));
  ENGRAM_ASSIGN_OR_RETURN(weights.floats, read_vector<float>(file, "/weights/floats"));
  torch::NoGradGuard no_grad;
  WeightReader reader(weights);
  ENGRAM_RETURN_IF_ERROR(
      for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) {
        return reader.read(name, tensor, is_buffer);
      }));
  if (!reader.is_at_end()) return data_loss("found more weights than the layout needs");
  return {};
}

}  // namespace engram::encoders
