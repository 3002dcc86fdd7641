// SPDX-License-Identifier: Apache-2.0
#include "encoders/model_weights.h"

#include <algorithm>
#include <cmath>

#include "encoders/coding/background_coder.h"
#include "encoders/coding/byte_stream.h"
#include "encoders/coding/weight_coder.h"
#include "encoders/layers.h"
#include "encoders/model_vectors.h"
#include "encoders/weight_rounding.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr const char* kMatricesPath = "/weights/matrices";
constexpr const char* kBackgroundsPath = "/weights/backgrounds";

/// Weights of a module in the order of their names, by the way they are stored.
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

/// Takes the next values of each kind, and checks that there are enough.
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

LatentGrid scene_shape(const Tensor& backgrounds) {
  return {static_cast<int>(backgrounds.size(1)), static_cast<int>(backgrounds.size(2)),
          static_cast<int>(backgrounds.size(3))};
}

/// Calls visit(name, tensor) for the tensors that are kept in one way.
template <typename Visit>
Status for_each_kept(DeepModel& model, Kept kept, Visit visit) {
  return for_each_tensor(model, [&](const auto& name, Tensor& tensor, bool is_buffer) -> Status {
    if (tensor.numel() == 0 || kept_as(name, tensor, is_buffer) != kept) return {};
    return visit(name, tensor);
  });
}

/// Codes tensors one after the other, a varint of its bytes before each.
class PartWriter {
 public:
  void put(const std::vector<std::byte>& bytes) {
    writer_.put_varint(static_cast<int64_t>(bytes.size()));
    for (const std::byte each : bytes) writer_.put(std::to_integer<uint8_t>(each));
  }
  Status write(h5::File& file, const std::string& path) {
    const std::vector<std::byte> bytes = writer_.take();
    const auto* first = reinterpret_cast<const uint8_t*>(bytes.data());
    return write_vector(file, path, std::vector<uint8_t>(first, first + bytes.size()));
  }

 private:
  ByteWriter writer_;
};

/// The next part of what PartWriter wrote.
Result<std::span<const std::byte>> next_part(std::span<const std::byte>& bytes,
                                             const std::string& name) {
  ByteReader reader(bytes);
  const int64_t size = reader.get_varint();
  const auto rest = reader.rest();
  if (reader.failed() || size < 0 || static_cast<uint64_t>(size) > rest.size())
    return data_loss("weights of '{}': found {} bytes of them, needs at most {}", name, size,
                     rest.size());
  bytes = rest.subspan(static_cast<size_t>(size));
  return rest.first(static_cast<size_t>(size));
}

Status check_end(std::span<const std::byte> bytes) {
  if (bytes.empty()) return {};
  return data_loss("found {} bytes of weights more than the layout needs", bytes.size());
}

Status write_matrices(h5::File& file, DeepModel& model, std::span<const int8_t> weights) {
  PartWriter parts;
  WeightCoder coder;
  ENGRAM_RETURN_IF_ERROR(for_each_kept(model, Kept::kBytes, [&](const auto&, Tensor& tensor) {
    const auto count = static_cast<size_t>(tensor.numel());
    parts.put(coder.encode(weights.first(count), count / static_cast<size_t>(tensor.size(0))));
    weights = weights.subspan(count);
    return Status();
  }));
  return parts.write(file, kMatricesPath);
}

Result<std::vector<int8_t>> read_matrices(const h5::File& file, DeepModel& model) {
  ENGRAM_ASSIGN_OR_RETURN(const auto stored, read_vector<uint8_t>(file, kMatricesPath));
  auto bytes = std::as_bytes(std::span(stored));
  std::vector<int8_t> weights;
  WeightCoder coder;
  ENGRAM_RETURN_IF_ERROR(
      for_each_kept(model, Kept::kBytes, [&](const auto& name, Tensor& tensor) -> Status {
        ENGRAM_ASSIGN_OR_RETURN(const auto part, next_part(bytes, name));
        const auto rows = static_cast<size_t>(tensor.size(0));
        ENGRAM_ASSIGN_OR_RETURN(
            const auto matrix,
            coder.decode(part, rows, static_cast<size_t>(tensor.numel()) / rows, name));
        weights.insert(weights.end(), matrix.begin(), matrix.end());
        return {};
      }));
  ENGRAM_RETURN_IF_ERROR(check_end(bytes));
  return weights;
}

Status write_backgrounds(h5::File& file, DeepModel& model, std::span<const uint8_t> pixels) {
  PartWriter parts;
  ENGRAM_RETURN_IF_ERROR(for_each_kept(model, Kept::kPixels, [&](const auto&, Tensor& tensor) {
    const auto count = static_cast<size_t>(tensor.numel());
    parts.put(encode_backgrounds(pixels.first(count), scene_shape(tensor)));
    pixels = pixels.subspan(count);
    return Status();
  }));
  return parts.write(file, kBackgroundsPath);
}

Result<std::vector<uint8_t>> read_backgrounds(const h5::File& file, DeepModel& model) {
  ENGRAM_ASSIGN_OR_RETURN(const auto stored, read_vector<uint8_t>(file, kBackgroundsPath));
  auto bytes = std::as_bytes(std::span(stored));
  std::vector<uint8_t> pixels;
  ENGRAM_RETURN_IF_ERROR(
      for_each_kept(model, Kept::kPixels, [&](const auto& name, Tensor& tensor) -> Status {
        ENGRAM_ASSIGN_OR_RETURN(const auto part, next_part(bytes, name));
        ENGRAM_ASSIGN_OR_RETURN(const auto scenes,
                                decode_backgrounds(part, static_cast<size_t>(tensor.size(0)),
                                                   scene_shape(tensor), name));
        pixels.insert(pixels.end(), scenes.begin(), scenes.end());
        return {};
      }));
  ENGRAM_RETURN_IF_ERROR(check_end(bytes));
  return pixels;
}

}  // namespace

Status write_weights(h5::File& file, DeepModel& model) {
  const Weights weights = collect(model);
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/scales", weights.scales));
  ENGRAM_RETURN_IF_ERROR(write_vector(file, "/weights/floats", weights.floats));
  ENGRAM_RETURN_IF_ERROR(write_matrices(file, model, weights.bytes));
  return write_backgrounds(file, model, weights.pixels);
}

Status read_weights(const h5::File& file, DeepModel& model) {
  Weights weights;
  ENGRAM_ASSIGN_OR_RETURN(const bool is_coded, file.exists(kMatricesPath));
  if (is_coded) {
    ENGRAM_ASSIGN_OR_RETURN(weights.bytes, read_matrices(file, model));
    ENGRAM_ASSIGN_OR_RETURN(weights.pixels, read_backgrounds(file, model));
  } else {  // Version 3.
    ENGRAM_ASSIGN_OR_RETURN(weights.bytes, read_vector<int8_t>(file, "/weights/bytes"));
    ENGRAM_ASSIGN_OR_RETURN(weights.pixels, read_vector<uint8_t>(file, "/weights/pixels"));
  }
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

std::vector<float> floats_of(const Tensor& tensor) {
  const Tensor rows = tensor.detach().to(torch::kFloat32).contiguous();
  return {rows.data_ptr<float>(), rows.data_ptr<float>() + rows.numel()};
}

}  // namespace engram::encoders
