// SPDX-License-Identifier: Apache-2.0
#include "encoders/deep_model.h"

#include <algorithm>
#include <cmath>

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr int kMaxNumberLatents = 128;
/// Images with a longer side than this are coded at a 16th of their resolution.
constexpr int kLargestFineImage = 256;
constexpr int64_t kLargestLatent = 1 << 20;

int padded(int size, int multiple) {
  return (size + multiple - 1) / multiple * multiple;
}

/// The pixels of an image, as they lie in memory. [1, H, W, C]
Tensor pixels_of(const ImageMember& image, const idf::NdArray& array) {
  return torch::from_blob(const_cast<std::byte*>(array.bytes().data()),
                          {1, image.height, image.width, image.channels},
                          image.is_depth ? torch::kInt16 : torch::kUInt8);
}

template <typename T>
idf::NdArray image_array(const ImageMember& image, const Tensor& pixels) {
  const Tensor rows = pixels.contiguous();
  const auto* values = rows.data_ptr<float>();
  std::vector<T> result;
  result.reserve(static_cast<size_t>(rows.numel()));
  constexpr float kLargest = std::numeric_limits<T>::max();
  for (int64_t i = 0; i < rows.numel(); ++i)
    result.push_back(static_cast<T>(std::nearbyint(std::clamp(values[i], 0.0f, kLargest))));
  return idf::NdArray::take<T>({image.height, image.width, image.channels}, std::move(result));
}

idf::NdArray to_array(const ImageMember& image, const Tensor& batch) {
  // A network that met values it never saw may answer with no number at all.
  const Tensor pixels = torch::nan_to_num(
      batch.select(0, 0).slice(1, 0, image.height).slice(2, 0, image.width).permute({1, 2, 0}), 0,
      0, 0);
  if (image.is_depth) return image_array<uint16_t>(image, pixels / image.scale);
  return image_array<uint8_t>(image, pixels);
}

}  // namespace

Tensor to_grey_levels(const ImageMember& image, const ImageShape& shape, const Tensor& pixels) {
  Tensor grey = pixels.permute({0, 3, 1, 2}).to(torch::kFloat32);  // [B, C, H, W]
  // LibTorch has no unsigned 16-bit type: the upper half came out negative.
  if (image.is_depth) grey = torch::where(grey < 0, grey + 65536.0, grey) * image.scale;
  const int below = shape.height - image.height;
  const int right = shape.width - image.width;
  if (below > 0 || right > 0) grey = torch::replication_pad2d(grey, {0, right, 0, below});
  return grey.contiguous(at::MemoryFormat::ChannelsLast);
}

NetworkShape network_shape(const TensorPlan& plan, int width, int latent_channels) {
  NetworkShape shape;
  shape.width = width;
  shape.latent_channels = latent_channels;
  for (const ImageMember& image : plan.images()) {
    const int stride = std::max(image.height, image.width) > kLargestFineImage ? 16 : 8;
    shape.images.push_back(
        {image.channels, padded(image.height, stride), padded(image.width, stride), stride});
  }
  shape.numbers = static_cast<int>(plan.number_count());
  shape.number_latents = std::min(shape.numbers, kMaxNumberLatents);
  return shape;
}

DeepModel::DeepModel(TensorPlan tensor_plan, const NetworkShape& shape)
    : plan(std::move(tensor_plan)),
      mean(plan.number_count(), 0.0),
      deviation(plan.number_count(), 0.0),
      autoencoder(shape),
      dynamics(shape) {}

std::vector<float> DeepModel::normalise(std::span<const double> numbers) const {
  std::vector<float> normalised(numbers.size(), 0.0f);
  for (size_t i = 0; i < numbers.size(); ++i) {
    const double number = deviation[i] > 0 ? (numbers[i] - mean[i]) / deviation[i] : 0.0;
    if (std::isfinite(number)) normalised[i] = static_cast<float>(std::clamp(number, -1e4, 1e4));
  }
  return normalised;
}

Result<Parts> DeepModel::to_parts(const idf::SplitValue& value) const {
  Parts parts;
  for (size_t i = 0; i < plan.images().size(); ++i) {
    const ImageMember& image = plan.images()[i];
    parts.images.push_back(to_grey_levels(image, autoencoder->shape.images[i],
                                          pixels_of(image, value.tensors[image.member])));
  }
  if (plan.number_count() == 0) return parts;
  const std::vector<float> normalised = normalise(plan.read_numbers(value));
  parts.numbers = torch::tensor(normalised).unsqueeze(0);
  return parts;
}

Result<idf::Data> DeepModel::to_value(const Parts& parts, const idf::List& remainder) const {
  idf::SplitValue value;
  value.tensors.resize(plan.layout().members().size());
  for (size_t i = 0; i < plan.images().size(); ++i)
    value.tensors[plan.images()[i].member] = to_array(plan.images()[i], parts.images[i]);
  if (plan.number_count() > 0) {
    const Tensor normalised = parts.numbers.select(0, 0).contiguous();
    std::vector<double> numbers;
    for (size_t i = 0; i < mean.size(); ++i)
      numbers.push_back(mean[i] + deviation[i] * normalised.data_ptr<float>()[i]);
    plan.write_numbers(numbers, value.tensors);
  }
  value.remainder = remainder;
  return plan.layout().join(value);
}

std::vector<int32_t> DeepModel::to_integers(const Parts& latents) const {
  std::vector<Tensor> all;
  for (const Tensor& image : latents.images) all.push_back(image.contiguous().flatten());
  if (latents.numbers.defined()) all.push_back(latents.numbers.flatten());
  const Tensor flat = torch::nan_to_num(torch::cat(all), 0, 0, 0)
                          .clamp(-kLargestLatent, kLargestLatent)
                          .to(torch::kInt32)
                          .contiguous();
  return {flat.data_ptr<int32_t>(), flat.data_ptr<int32_t>() + flat.numel()};
}

Parts DeepModel::to_latents(std::span<const int32_t> integers) const {
  Parts latents;
  const std::vector<LatentGrid> grids = autoencoder->shape.grids();
  for (size_t i = 0; i < grids.size(); ++i) {
    const LatentGrid& grid = grids[i];
    std::vector<float> values(integers.begin(),
                              integers.begin() + static_cast<std::ptrdiff_t>(grid.count()));
    for (float& value : values) value = std::clamp(value, -1e6f, 1e6f);
    integers = integers.subspan(grid.count());
    Tensor tensor = torch::tensor(values);
    if (i < autoencoder->shape.images.size())
      latents.images.push_back(tensor.reshape({1, grid.channels, grid.height, grid.width})
                                   .contiguous(at::MemoryFormat::ChannelsLast));
    else
      latents.numbers = tensor.reshape({1, grid.channels});
  }
  return latents;
}

Result<ltm::Latent> DeepModel::encode(const idf::Data& value) {
  torch::NoGradGuard no_grad;
  ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue split, plan.layout().split(value));
  ENGRAM_ASSIGN_OR_RETURN(const Parts parts, to_parts(split));
  const auto integers = to_integers(round(autoencoder->encode(parts)));
  return ltm::Latent{Buffer::take(coder.encode(integers)), std::move(split.remainder)};
}

Result<idf::Data> DeepModel::decode(const ltm::Latent& latent) {
  torch::NoGradGuard no_grad;
  ENGRAM_ASSIGN_OR_RETURN(const auto integers, coder.decode(latent.code.bytes()));
  auto value = to_value(autoencoder->decode(to_latents(integers)), latent.remainder);
  if (!value.ok()) return data_loss("latent: {}", value.status().message());
  return value;
}

float weight_scale(float largest) {
  if (!(largest > 0)) return 1.0f;
  // Few enough bits that 127 * scale is exact: rounding rounded weights changes nothing.
  int exponent = 0;
  const float fraction = std::frexp(largest / 127.0f, &exponent);
  return std::ldexp(std::ceil(fraction * 1024.0f) / 1024.0f, exponent);
}

Kept kept_as(const std::string& name, const Tensor& tensor, bool is_buffer) {
  if (name.ends_with("background")) return Kept::kPixels;
  const bool is_matrix = tensor.dim() == 2 || tensor.dim() == 4;
  const bool is_prior = name.ends_with("prior") || name.ends_with("log_spread");
  return is_matrix && !is_prior && !is_buffer ? Kept::kBytes : Kept::kFloats;
}

void round_weights(torch::nn::Module& module) {
  torch::NoGradGuard no_grad;
  for (auto& item : module.named_parameters()) {
    Tensor& weights = item.value();
    const Kept kept = kept_as(item.key(), weights, false);
    if (kept == Kept::kPixels) {
      weights.copy_((weights * kGreyLevels).round().clamp(0, 255) / kGreyLevels);
    } else if (kept == Kept::kBytes) {
      for (int64_t row = 0; row < weights.size(0); ++row) {
        Tensor channel = weights.select(0, row);
        const float scale = weight_scale(channel.abs().max().item<float>());
        channel.copy_((channel / scale).round().clamp(-127, 127) * scale);
      }
    }
  }
}

Parts mix(const Parts& last, const Parts& predicted, double image_gate, double number_gate) {
  Parts mixed;
  for (size_t i = 0; i < last.images.size(); ++i)
    mixed.images.push_back(last.images[i] + image_gate * (predicted.images[i] - last.images[i]));
  if (last.numbers.defined())
    mixed.numbers = last.numbers + number_gate * (predicted.numbers - last.numbers);
  return mixed;
}

namespace {

class DeepEncoder : public ltm::Encoder {
 public:
  explicit DeepEncoder(std::shared_ptr<DeepModel> model) : model_(std::move(model)) {}

  // One at a time: an answer must not depend on what is decoded beside it.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values) override {
    return guarded("encode", [&]() -> Result<std::vector<ltm::Latent>> {
      std::vector<ltm::Latent> latents;
      for (const idf::Data& value : values) {
        ENGRAM_ASSIGN_OR_RETURN(ltm::Latent latent, model_->encode(value));
        latents.push_back(std::move(latent));
      }
      return latents;
    });
  }

  Result<std::vector<idf::Data>> decode(std::span<const ltm::Latent> latents) override {
    return guarded("decode", [&]() -> Result<std::vector<idf::Data>> {
      std::vector<idf::Data> values;
      for (const ltm::Latent& latent : latents) {
        ENGRAM_ASSIGN_OR_RETURN(idf::Data value, model_->decode(latent));
        values.push_back(std::move(value));
      }
      return values;
    });
  }

 private:
  std::shared_ptr<DeepModel> model_;
};

class DeepPredictor : public ltm::Predictor {
 public:
  explicit DeepPredictor(std::shared_ptr<DeepModel> model) : model_(std::move(model)) {}

  [[nodiscard]] std::string_view name() const override { return "deep"; }
  [[nodiscard]] Duration step() const override { return model_->prediction.step; }
  [[nodiscard]] size_t context() const override { return 2; }

  Result<std::vector<idf::Data>> predict(std::span<const idf::Data> history, int steps) override {
    if (history.empty()) return invalid_argument("predict: found no history, needs one value");
    if (steps < 1) return invalid_argument("predict: found {} steps, needs at least 1", steps);
    return guarded("predict", [&] { return predict_checked(history, steps); });
  }

  [[nodiscard]] ltm::MeasuredError expected_error(int steps) const override {
    return model_->prediction.expected[index_of(steps)];
  }

 private:
  static size_t index_of(int steps) {
    return static_cast<size_t>(std::clamp(steps, 1, kMeasuredHorizons) - 1);
  }

  Result<std::vector<idf::Data>> predict_checked(std::span<const idf::Data> history, int steps) {
    torch::NoGradGuard no_grad;
    const auto& layout = model_->plan.layout();
    ENGRAM_ASSIGN_OR_RETURN(const auto split, layout.split(history.back()));
    ENGRAM_ASSIGN_OR_RETURN(const auto earlier,
                            layout.split(history[history.size() > 1 ? history.size() - 2 : 0]));
    ENGRAM_ASSIGN_OR_RETURN(const Parts last, model_->to_parts(split));
    ENGRAM_ASSIGN_OR_RETURN(const Parts before, model_->to_parts(earlier));
    const auto futures = roll_out(model_->autoencoder, model_->dynamics, last,
                                  round(model_->autoencoder->encode(last)),
                                  round(model_->autoencoder->encode(before)), steps);
    std::vector<idf::Data> values;
    for (int i = 0; i < steps; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(idf::Data value, value_at(history.back(), split, last,
                                                        futures[static_cast<size_t>(i)], i));
      values.push_back(std::move(value));
    }
    return values;
  }

  // Members whose gate is closed keep the last value bit for bit.
  Result<idf::Data> value_at(const idf::Data& newest, const idf::SplitValue& split,
                             const Parts& last, const Parts& future, int step) const {
    const size_t horizon = index_of(step + 1);
    const double image_gate = model_->prediction.image_gates[horizon];
    const double number_gate = model_->prediction.number_gates[horizon];
    if (image_gate == 0 && number_gate == 0) return newest;
    ENGRAM_ASSIGN_OR_RETURN(
        const idf::Data value,
        model_->to_value(mix(last, future, image_gate, number_gate), split.remainder));
    ENGRAM_ASSIGN_OR_RETURN(idf::SplitValue parts, model_->plan.layout().split(value));
    if (image_gate == 0)
      for (const ImageMember& image : model_->plan.images())
        parts.tensors[image.member] = split.tensors[image.member];
    if (number_gate == 0)
      for (const NumberMember& number : model_->plan.numbers())
        parts.tensors[number.member] = split.tensors[number.member];
    return model_->plan.layout().join(parts);
  }

  std::shared_ptr<DeepModel> model_;
};

}  // namespace

std::unique_ptr<ltm::Encoder> make_encoder(std::shared_ptr<DeepModel> model) {
  return std::make_unique<DeepEncoder>(std::move(model));
}

std::unique_ptr<ltm::Predictor> make_predictor(std::shared_ptr<DeepModel> model) {
  return std::make_unique<DeepPredictor>(std::move(model));
}

}  // namespace engram::encoders
