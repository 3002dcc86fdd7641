// SPDX-License-Identifier: Apache-2.0
#include "encoders/deep_model.h"

#include <algorithm>
#include <cmath>

namespace engram::encoders {

using torch::Tensor;

namespace {

constexpr int64_t kLargestLatent = 1 << 20;

/// The pixels of an image in memory order. Shape: [1, H, W, C].
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

/// Shape: [1, z, h, w].
Tensor grid_tensor(const LatentGrid& grid, std::span<const int32_t> integers) {
  std::vector<float> values(integers.begin(), integers.end());
  for (float& value : values) value = std::clamp(value, -1e6f, 1e6f);
  return torch::tensor(values)
      .reshape({1, grid.channels, grid.height, grid.width})
      .contiguous(at::MemoryFormat::ChannelsLast);
}

}  // namespace

idf::NdArray to_image_array(const ImageMember& image, const Tensor& batch) {
  // For values unlike the training data a network may return NaN.
  const Tensor pixels = torch::nan_to_num(
      batch.select(0, 0).slice(1, 0, image.height).slice(2, 0, image.width).permute({1, 2, 0}), 0,
      0, 0);
  if (image.is_depth) return image_array<uint16_t>(image, pixels / image.scale);
  return image_array<uint8_t>(image, pixels);
}

Tensor to_grey_levels(const ImageMember& image, const ImageShape& shape, const Tensor& pixels) {
  Tensor grey = pixels.permute({0, 3, 1, 2}).to(torch::kFloat32);  // [B, C, H, W]
  // LibTorch has no unsigned 16-bit type, so the upper half of the range is negative here.
  if (image.is_depth) grey = torch::where(grey < 0, grey + 65536.0, grey) * image.scale;
  const int below = shape.height - image.height;
  const int right = shape.width - image.width;
  if (below > 0 || right > 0) grey = torch::replication_pad2d(grey, {0, right, 0, below});
  return grey.contiguous(at::MemoryFormat::ChannelsLast);
}

DeepModel::DeepModel(TensorPlan tensor_plan, const NetworkSizes& sizes)
    : plan(std::move(tensor_plan)),
      mean(plan.number_count(), 0.0),
      deviation(plan.number_count(), 0.0),
      autoencoder(network_shape(plan, sizes)),
      dynamics(autoencoder->shape) {
  codec.scenes = static_cast<uint32_t>(sizes.scenes);
  for (const ImageMember& image : plan.images())
    codec.chain.frames.push_back(
        {image.is_depth ? idf::ElementType::kUInt16 : idf::ElementType::kUInt8,
         {image.height, image.width, image.channels}});
}

std::vector<float> DeepModel::normalise(std::span<const double> numbers) const {
  return normalised(numbers, mean, deviation);
}

Result<Parts> DeepModel::to_parts(const idf::SplitValue& value) const {
  Parts parts;
  parts.scene = torch::zeros({1}, torch::kLong);
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

std::vector<idf::NdArray> DeepModel::to_arrays(const Parts& parts) const {
  std::vector<idf::NdArray> arrays(parts.images.size());
  for (size_t i = 0; i < arrays.size(); ++i)
    if (parts.images[i].defined()) arrays[i] = to_image_array(plan.images()[i], parts.images[i]);
  return arrays;
}

Result<idf::Data> DeepModel::to_value(std::vector<idf::NdArray> images,
                                      std::span<const double> numbers,
                                      const idf::List& remainder) const {
  idf::SplitValue value;
  value.tensors.resize(plan.layout().members().size());
  for (size_t i = 0; i < images.size(); ++i)
    value.tensors[plan.images()[i].member] = std::move(images[i]);
  if (plan.number_count() > 0) plan.write_numbers(numbers, value.tensors);
  value.remainder = remainder;
  return plan.layout().join(value);
}

std::vector<double> DeepModel::moved_numbers(std::vector<double> numbers, const Parts& last,
                                             const Parts& then) const {
  if (numbers.empty()) return numbers;
  const Tensor from = last.numbers.select(0, 0).contiguous();
  const Tensor to = then.numbers.select(0, 0).contiguous();
  for (size_t i = 0; i < numbers.size(); ++i) {
    const double now = from.data_ptr<float>()[i];
    const double next = to.data_ptr<float>()[i];
    // A number that is not finite counts as the mean.
    numbers[i] = std::isfinite(numbers[i]) ? numbers[i] + deviation[i] * (next - now)
                                           : mean[i] + deviation[i] * next;
  }
  return numbers;
}

ltm::MeasuredError DeepModel::difference(const Parts& a, const Parts& b) const {
  ltm::MeasuredError error;
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < plan.images().size(); ++i) {
    const ImageMember& image = plan.images()[i];
    const Tensor squares =
        (a.images[i] - b.images[i]).slice(2, 0, image.height).slice(3, 0, image.width).square();
    sum += squares.sum(torch::kFloat64).item<double>();
    count += static_cast<double>(squares.numel());
  }
  if (count > 0) error.image_mse = sum / count;
  if (plan.number_count() > 0)
    error.number_mse = ((a.numbers - b.numbers).to(torch::kFloat64) * torch::tensor(deviation))
                           .square()
                           .mean()
                           .item<double>();
  return error;
}

std::vector<int32_t> DeepModel::to_integers(const ImageLatents& latents) {
  const Tensor flat =
      torch::nan_to_num(
          torch::cat({latents.coarse.contiguous().flatten(), latents.fine.contiguous().flatten()}),
          0, 0, 0)
          .clamp(-kLargestLatent, kLargestLatent)
          .to(torch::kInt32)
          .contiguous();
  return {flat.data_ptr<int32_t>(), flat.data_ptr<int32_t>() + flat.numel()};
}

Latents DeepModel::to_latents(const LatentRows& rows, size_t row) const {
  Latents latents{{},
                  {},
                  torch::tensor({static_cast<int64_t>(rows.scene)}, torch::kLong),
                  backgrounds_of(rows)};
  for (size_t i = 0; i < rows.images.size(); ++i) {
    if (rows.images[i].form != ImageForm::kLatents) {
      latents.images.emplace_back();
      continue;
    }
    const std::vector<LatentGrid> grids = autoencoder->shape.grids(i);
    const size_t each = grids[0].count() + grids[1].count();
    const auto integers = std::span(rows.images[i].latents).subspan(row * each, each);
    latents.images.push_back({grid_tensor(grids[0], integers.first(grids[0].count())),
                              grid_tensor(grids[1], integers.subspan(grids[0].count()))});
  }
  if (const size_t count = plan.number_count(); count > 0)
    latents.numbers =
        torch::tensor(normalise(std::span(rows.numbers).subspan(row * count, count))).unsqueeze(0);
  return latents;
}

std::vector<Tensor> DeepModel::backgrounds_of(const LatentRows& rows) const {
  std::vector<Tensor> backgrounds;
  for (size_t i = 0; i < rows.own.size(); ++i)
    backgrounds.push_back(to_grey_levels(plan.images()[i], autoencoder->shape.images[i],
                                         pixels_of(plan.images()[i], rows.own[i].pixels)));
  return backgrounds;
}

Result<LatentRows> DeepModel::to_rows(std::span<const idf::SplitValue> values,
                                      std::vector<CodedBackground> own) {
  torch::NoGradGuard no_grad;
  LatentRows rows;
  rows.own = std::move(own);
  rows.images.resize(plan.images().size());
  for (const idf::SplitValue& value : values) {
    const std::vector<double> numbers = plan.read_numbers(value);
    rows.numbers.insert(rows.numbers.end(), numbers.begin(), numbers.end());
  }
  if (autoencoder->images.empty()) return rows;
  std::vector<Parts> parts;
  for (const idf::SplitValue& value : values) {
    ENGRAM_ASSIGN_OR_RETURN(parts.emplace_back(), to_parts(value));
  }
  add_latents(std::move(parts), rows);
  return rows;
}

void DeepModel::add_latents(std::vector<Parts> parts, LatentRows& rows) {
  const Tensor scene = best_scene(parts);
  rows.scene = static_cast<uint32_t>(scene.item<int64_t>());
  const std::vector<Tensor> backgrounds = backgrounds_of(rows);
  // Values are encoded one at a time, because the latents of one must not depend on the others in a
  // batch.
  for (Parts& one : parts) {
    one.scene = scene;
    one.backgrounds = backgrounds;
    const Latents rounded = round(autoencoder->encode(one));
    for (size_t i = 0; i < rounded.images.size(); ++i) {
      const std::vector<int32_t> integers = to_integers(rounded.images[i]);
      auto& all = rows.images[i].latents;
      all.insert(all.end(), integers.begin(), integers.end());
    }
  }
}

Tensor DeepModel::best_scene(std::span<const Parts> parts) {
  // The nearest backgrounds are tried on the first, the middle and the last row.
  constexpr int64_t kTried = 4;
  Tensor distances = torch::zeros({1, autoencoder->shape.sizes.scenes});
  for (const Parts& one : parts) distances = distances + autoencoder->distances(one);
  const Tensor nearest = distances.squeeze(0).argsort().slice(0, 0, kTried);
  Tensor best = nearest.slice(0, 0, 1);
  if (nearest.size(0) == 1) return best;
  double min = std::numeric_limits<double>::infinity();
  for (int64_t i = 0; i < nearest.size(0); ++i) {
    const Tensor scene = nearest.slice(0, i, i + 1);
    double error = 0;
    for (const size_t row : {size_t{0}, parts.size() / 2, parts.size() - 1})
      error += reconstruction_error(parts[row], scene);
    if (error >= min) continue;
    min = error;
    best = scene;
  }
  return best;
}

double DeepModel::reconstruction_error(Parts values, const Tensor& scene) {
  values.scene = scene;
  const Parts decoded = autoencoder->decode(round(autoencoder->encode(values)));
  double error = 0;
  for (size_t i = 0; i < values.images.size(); ++i)
    error += (decoded.images[i] - values.images[i]).square().sum().item<double>();
  return error;
}

Result<std::vector<idf::NdArray>> DeepModel::decode_images(const LatentRows& rows, size_t row) {
  torch::NoGradGuard no_grad;
  const bool has_latents = std::ranges::any_of(
      rows.images, [](const ImageRows& image) { return image.form == ImageForm::kLatents; });
  std::vector<idf::NdArray> images(rows.images.size());
  if (has_latents) images = to_arrays(autoencoder->decode(to_latents(rows, row)));
  for (size_t i = 0; i < images.size(); ++i) {
    const ImageRows& kept = rows.images[i];
    if (kept.form != ImageForm::kLatents) images[i] = kept.frames[row];
    if (!kept.residuals.empty() && !kept.residuals[row].empty())
      images[i] = with_residual(images[i], kept.residuals[row], codec.chain.frames[i].pixels());
  }
  return images;
}

Result<idf::Data> DeepModel::decode(const LatentRows& rows, size_t row,
                                    const idf::List& remainder) {
  const size_t count = plan.number_count();
  const auto numbers = std::span(rows.numbers).subspan(row * count, count);
  ENGRAM_ASSIGN_OR_RETURN(std::vector<idf::NdArray> images, decode_images(rows, row));
  auto value = to_value(std::move(images), numbers, remainder);
  if (!value.ok()) return data_loss("latent: {}", value.status().message());
  return value;
}

std::vector<Future> futures_of(DeepModel& model, const Parts& last, const Parts& before,
                               std::span<const FutureNeed> needs) {
  std::vector<int> of_latents;
  int of_motion = 0;
  for (const FutureNeed& need : needs) {
    if (need.latents) of_latents.push_back(need.step);
    if (need.motion) of_motion = need.step;
  }
  std::vector<Parts> latents;
  if (!of_latents.empty())
    latents =
        roll_out(model.autoencoder, model.dynamics, last, round(model.autoencoder->encode(last)),
                 round(model.autoencoder->encode(before)), of_latents);
  auto motion = of_motion > 0 ? model.dynamics->move(last, before, of_motion)
                              : std::vector<std::vector<Tensor>>{};
  std::vector<Future> futures(needs.size());
  size_t next = 0;
  for (size_t i = 0; i < needs.size(); ++i) {
    if (needs[i].latents) futures[i].latents = std::move(latents[next++]);
    if (needs[i].motion)
      futures[i].motion = std::move(motion[static_cast<size_t>(needs[i].step) - 1]);
  }
  return futures;
}

std::vector<Future> futures_of(DeepModel& model, const Parts& last, const Parts& before,
                               int steps) {
  std::vector<FutureNeed> needs;
  for (int step = 1; step <= steps; ++step) needs.push_back({step});
  return futures_of(model, last, before, needs);
}

Parts mix(const Parts& last, const Future& future, const BlendShares& shares) {
  Parts mixed;
  for (size_t i = 0; i < last.images.size(); ++i) {
    Tensor image = last.images[i];
    if (shares.latents > 0)
      image = image + shares.latents * (future.latents.images[i] - last.images[i]);
    if (shares.motion > 0 && !future.motion.empty())
      image = image + shares.motion * (future.motion[i] - last.images[i]);
    mixed.images.push_back(image);
  }
  mixed.numbers = last.numbers;
  if (last.numbers.defined() && shares.numbers > 0)
    mixed.numbers = last.numbers + shares.numbers * (future.latents.numbers - last.numbers);
  return mixed;
}

}  // namespace engram::encoders
