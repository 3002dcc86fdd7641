// SPDX-License-Identifier: Apache-2.0
#include "encoders/autoencoder.h"

#include <algorithm>

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Factor of the encoder's output. It makes latents large enough that rounding costs little in the
/// beginning.
constexpr double kLatentGain = 4.0;

}  // namespace

ImageEncoderImpl::ImageEncoderImpl(const ImageShape& shape, const NetworkSizes& sizes)
    : unit(shape.unit) {
  const int quarter_features = sizes.width * 3 / 8;
  const int eighth_features = sizes.width / 2;
  const int sixteenth_features = sizes.width * 3 / 4;
  // The order is that of the tensors in a model file (layers.h).
  stem = register_module("stem", make_conv(16 * unit * unit * shape.channels, quarter_features, 3));
  quarter = register_module("quarter", ResidualBlock(quarter_features));
  to_eighth = register_module("to_eighth", make_conv(4 * quarter_features, eighth_features, 1));
  eighth = register_module("eighth", ResidualBlock(eighth_features));
  fine = register_module("fine", make_conv(eighth_features, sizes.fine_channels, 1));
  to_sixteenth =
      register_module("to_sixteenth", make_conv(4 * eighth_features, sixteenth_features, 1));
  sixteenth = register_module("sixteenth", ResidualBlocks(sixteenth_features, 2));
  coarse = register_module("coarse", make_conv(sixteenth_features, sizes.coarse_channels, 1));
}

ImageLatents ImageEncoderImpl::forward(const Tensor& image, const View& view) {
  Tensor x = with_known(stem(unshuffled(image, 4 * unit)), view.quarter);
  x = quarter(activate(x));          // [B, 3F/8, H/4, W/4]
  x = eighth(halved(to_eighth, x));  // [B, F/2, H/8, W/8]
  const Tensor fine_latents = fine(x) * kLatentGain;
  x = halved(to_sixteenth, x);  // [B, 3F/4, H/16, W/16]
  return {coarse(sixteenth(x)) * kLatentGain, fine_latents};
}

ImageDecoderImpl::ImageDecoderImpl(const ImageShape& shape, const NetworkSizes& sizes, int numbers)
    : unit(shape.unit) {
  const int sixteenth_features = sizes.width;
  const int eighth_features = sizes.width * 3 / 4;
  const int quarter_features = sizes.width * 3 / 8;
  const int half_features = sizes.width * 3 / 16;
  // The order is that of the tensors in a model file (layers.h).
  from_coarse =
      register_module("from_coarse", make_conv(sizes.coarse_channels, sixteenth_features, 3));
  from_fine = register_module("from_fine", make_conv(sizes.fine_channels, eighth_features, 3));
  if (numbers > 0)
    from_numbers = register_module("from_numbers", make_zero_linear(numbers, sixteenth_features));
  sixteenth = register_module("sixteenth", ResidualBlocks(sixteenth_features, 2));
  to_eighth = register_module("to_eighth", make_conv(sixteenth_features, 4 * eighth_features, 1));
  eighth = register_module("eighth", ResidualBlocks(eighth_features, 2));
  to_quarter = register_module("to_quarter", make_conv(eighth_features, 4 * quarter_features, 1));
  quarter = register_module("quarter", ResidualBlocks(quarter_features, 2));
  to_half = register_module("to_half", make_conv(quarter_features, 4 * half_features, 1));
  half = register_module("half", ResidualBlock(half_features));
  out = register_module("out", make_conv(half_features, 4 * unit * unit * shape.channels, 3));
  torch::NoGradGuard no_grad;
  out->weight.normal_(0, 0.02);
}

Tensor ImageDecoderImpl::forward(const ImageLatents& latents, const Tensor& numbers,
                                 const View& view) {
  Tensor x = with_known(from_coarse(latents.coarse), view.sixteenth);
  if (from_numbers) x = with_features(x, from_numbers(numbers));
  x = sixteenth(x);                                         // [B, F, H/16, W/16]
  x = from_fine(latents.fine).add_(doubled(to_eighth, x));  // [B, 3F/4, H/8, W/8]
  x = eighth(with_known(activate(std::move(x)), view.eighth));
  x = doubled(to_quarter, x);  // [B, 3F/8, H/4, W/4]
  x = quarter(with_known(activate(x), view.quarter));
  x = doubled(to_half, x);                                        // [B, 3F/16, H/2, W/2]
  return torch::pixel_shuffle(out(half(activate(x))), 2 * unit);  // [B, C, H, W]
}

ImageAutoencoderImpl::ImageAutoencoderImpl(const ImageShape& shape, const NetworkSizes& sizes,
                                           int numbers)
    : background(register_parameter(
          "background", torch::zeros({sizes.scenes, shape.channels, shape.height, shape.width}))),
      places(register_module("places", PlaceFeatures(shape, sizes))),
      encoder(register_module("encoder", ImageEncoder(shape, sizes))),
      decoder(register_module("decoder", ImageDecoder(shape, sizes, numbers))) {}

ImageLatents ImageAutoencoderImpl::encode(const Tensor& x, const View& view) {
  // Backgrounds learn from the decoder's output alone. Cutting gradients here saves 3 ms of a step
  // and costs no measurable quality (experiments/learning/LOG.md).
  return encoder(with_known(x / kGreyLevels, -view.background.detach()), view);
}

Tensor ImageAutoencoderImpl::decode(const ImageLatents& latents, const Tensor& numbers,
                                    const View& view) {
  return with_known(decoder(latents, numbers, view), view.background) * kGreyLevels;
}

AutoencoderImpl::AutoencoderImpl(const NetworkShape& network) : shape(network) {
  if (shape.sizes.width == 0) return;
  for (size_t i = 0; i < shape.images.size(); ++i)
    images.push_back(
        register_module("image" + std::to_string(i),
                        ImageAutoencoder(shape.images[i], shape.sizes, shape.numbers)));
}

Views AutoencoderImpl::look(const Tensor& scene, const std::vector<Tensor>& backgrounds) {
  Views views;
  for (size_t i = 0; i < images.size(); ++i) {
    const Tensor background = backgrounds.empty() ? images[i]->background.index_select(0, scene)
                                                  : backgrounds[i] / kGreyLevels;
    views.push_back(
        images[i]->places(background.contiguous(at::MemoryFormat::ChannelsLast), scene));
  }
  return views;
}

int64_t AutoencoderImpl::weights_version() const {
  int64_t version = 0;
  for (const ImageAutoencoder& image : images) {
    version += image->background._version();
    for (const Tensor& weights : image->places->parameters()) version += weights._version();
  }
  return version;
}

Views AutoencoderImpl::views_of(const Tensor& scene, const std::vector<Tensor>& backgrounds) {
  const bool is_known = backgrounds.empty();
  const bool is_one = !is_known || (scene.size(0) > 0 && scene.min().equal(scene.max()));
  const Tensor row = !is_known ? torch::full({1}, -1, torch::kLong)
                     : is_one  ? scene.slice(0, 0, 1)
                               : scene;
  // Views with gradients belong to one graph and are never kept.
  if (!is_one || torch::GradMode::is_enabled()) return look(row, backgrounds);
  const auto is_same = [](const Tensor& a, const Tensor& b) { return a.equal(b); };
  const int64_t version = weights_version();
  const bool is_last = last_views_.weights_version == version && last_views_.scene.equal(row) &&
                       std::ranges::equal(last_views_.backgrounds, backgrounds, is_same);
  if (!is_last) last_views_ = {row, backgrounds, version, look(row, backgrounds)};
  return last_views_.views;
}

Latents AutoencoderImpl::encode(const Parts& values, const Views& views) {
  Latents latents{{}, values.numbers, values.scene, values.backgrounds};
  for (size_t i = 0; i < images.size(); ++i)
    latents.images.push_back(images[i]->encode(values.images[i], views[i]));
  return latents;
}

Parts AutoencoderImpl::decode(const Latents& latents, const Views& views) {
  Parts values{{}, latents.numbers, latents.scene, latents.backgrounds};
  for (size_t i = 0; i < images.size(); ++i)
    values.images.push_back(latents.images[i].coarse.defined()
                                ? images[i]->decode(latents.images[i], latents.numbers, views[i])
                                : Tensor());
  return values;
}

Tensor AutoencoderImpl::distances(const Parts& values) {
  Tensor sum = torch::zeros({values.scene.size(0), shape.sizes.scenes});
  for (size_t i = 0; i < images.size(); ++i) {
    std::vector<Tensor> columns;
    for (int64_t scene = 0; scene < shape.sizes.scenes; ++scene)
      columns.push_back((values.images[i] - images[i]->background.select(0, scene) * kGreyLevels)
                            .abs()
                            .sum({1, 2, 3}));
    sum = sum + torch::stack(columns, 1);
  }
  return sum;
}

Latents round(const Latents& latents) {
  Latents rounded{{}, latents.numbers, latents.scene, latents.backgrounds};
  for (const ImageLatents& image : latents.images)
    rounded.images.push_back({image.coarse.round(), image.fine.round()});
  return rounded;
}

}  // namespace engram::encoders
