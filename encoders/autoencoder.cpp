// SPDX-License-Identifier: Apache-2.0
#include "encoders/autoencoder.h"

#include <algorithm>

namespace engram::encoders {

using torch::Tensor;

namespace {

/// What the encoder's output is multiplied by, so that rounding costs little in the beginning.
constexpr double kLatentGain = 4.0;

}  // namespace

ImageEncoderImpl::ImageEncoderImpl(const ImageShape& shape, const NetworkSizes& sizes)
    : unit(shape.unit) {
  const int a = sizes.width * 3 / 8;
  const int b = sizes.width / 2;
  const int c = sizes.width * 3 / 4;
  stem = register_module("stem", make_conv(16 * unit * unit * shape.channels, a, 3));
  quarter = register_module("quarter", ResidualBlock(a));
  to_eighth = register_module("to_eighth", make_conv(4 * a, b, 1));
  eighth = register_module("eighth", ResidualBlock(b));
  fine = register_module("fine", make_conv(b, sizes.fine_channels, 1));
  to_sixteenth = register_module("to_sixteenth", make_conv(4 * b, c, 1));
  sixteenth_1 = register_module("sixteenth_1", ResidualBlock(c));
  sixteenth_2 = register_module("sixteenth_2", ResidualBlock(c));
  coarse = register_module("coarse", make_conv(c, sizes.coarse_channels, 1));
}

ImageLatents ImageEncoderImpl::forward(const Tensor& image, const View& view) {
  Tensor x = with_known(stem(unshuffled(image, 4 * unit)), view.quarter);
  x = quarter(activate(x));          // [B, 3F/8, H/4, W/4]
  x = eighth(halved(to_eighth, x));  // [B, F/2, H/8, W/8]
  const Tensor z = fine(x) * kLatentGain;
  x = halved(to_sixteenth, x);  // [B, 3F/4, H/16, W/16]
  return {coarse(sixteenth_2(sixteenth_1(x))) * kLatentGain, z};
}

ImageDecoderImpl::ImageDecoderImpl(const ImageShape& shape, const NetworkSizes& sizes, int numbers)
    : unit(shape.unit) {
  const int a = sizes.width;
  const int b = a * 3 / 4;
  const int c = a * 3 / 8;
  const int d = a * 3 / 16;
  from_coarse = register_module("from_coarse", make_conv(sizes.coarse_channels, a, 3));
  from_fine = register_module("from_fine", make_conv(sizes.fine_channels, b, 3));
  if (numbers > 0) from_numbers = register_module("from_numbers", make_zero_linear(numbers, a));
  sixteenth_1 = register_module("sixteenth_1", ResidualBlock(a));
  sixteenth_2 = register_module("sixteenth_2", ResidualBlock(a));
  to_eighth = register_module("to_eighth", make_conv(a, 4 * b, 1));
  eighth_1 = register_module("eighth_1", ResidualBlock(b));
  eighth_2 = register_module("eighth_2", ResidualBlock(b));
  to_quarter = register_module("to_quarter", make_conv(b, 4 * c, 1));
  quarter_1 = register_module("quarter_1", ResidualBlock(c));
  quarter_2 = register_module("quarter_2", ResidualBlock(c));
  to_half = register_module("to_half", make_conv(c, 4 * d, 1));
  half = register_module("half", ResidualBlock(d));
  out = register_module("out", make_conv(d, 4 * unit * unit * shape.channels, 3));
  torch::NoGradGuard no_grad;
  out->weight.normal_(0, 0.02);
}

Tensor ImageDecoderImpl::forward(const ImageLatents& latents, const Tensor& numbers,
                                 const View& view) {
  Tensor x = with_known(from_coarse(latents.coarse), view.sixteenth);
  if (from_numbers) x = with_features(x, from_numbers(numbers));
  x = sixteenth_2(sixteenth_1(x));                          // [B, F, H/16, W/16]
  x = from_fine(latents.fine).add_(doubled(to_eighth, x));  // [B, 3F/4, H/8, W/8]
  x = eighth_2(eighth_1(with_known(activate(std::move(x)), view.eighth)));
  x = doubled(to_quarter, x);  // [B, 3F/8, H/4, W/4]
  x = quarter_2(quarter_1(with_known(activate(x), view.quarter)));
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
