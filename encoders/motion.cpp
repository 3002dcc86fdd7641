// SPDX-License-Identifier: Apache-2.0
#include "encoders/motion.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Displacement of a flow of one, in pixels of an image with one unit.
constexpr double kFlowPixels = 8.0;
/// Initial logit of masks and shares: they start 27 % open.
constexpr double kFirstMask = -1.0;

Tensor enlarged(const Tensor& x, int factor) {
  namespace F = torch::nn::functional;
  const double scale = factor;
  return F::interpolate(x, F::InterpolateFuncOptions()
                               .scale_factor(std::vector<double>{scale, scale})
                               .mode(torch::kBilinear)
                               .align_corners(false));
}

}  // namespace

Tensor warp(const Tensor& x, const Tensor& flow) {
  namespace F = torch::nn::functional;
  const int64_t height = x.size(2);
  const int64_t width = x.size(3);
  // grid_sample takes places from -1 to 1, which are the outer edges of the first and the last
  // pixel.
  const auto places = [](int64_t count) {
    return (torch::arange(count, torch::kFloat32) * 2 + 1) / static_cast<double>(count) - 1;
  };
  const std::vector<Tensor> plain = torch::meshgrid({places(height), places(width)}, "ij");
  const Tensor right = flow.select(1, 0) * (2.0 / static_cast<double>(width)) + plain[1];
  const Tensor down = flow.select(1, 1) * (2.0 / static_cast<double>(height)) + plain[0];
  return F::grid_sample(x, torch::stack({right, down}, 3),
                        F::GridSampleFuncOptions()
                            .mode(torch::kBilinear)
                            .padding_mode(torch::kBorder)
                            .align_corners(false));
}

ImageMotionImpl::ImageMotionImpl(const ImageShape& shape, int features, int added)
    : unit(shape.unit), channels(shape.channels) {
  const int eighth_features = 2 * features;
  const int sixteenth_features = 4 * features;
  const int pixels = 16 * unit * unit;
  // The order is that of the tensors in a model file (layers.h).
  stem = register_module("stem", make_conv((3 + kSteps) * channels * pixels, features, 3));
  quarter_down = register_module("quarter_down", ResidualBlock(features));
  to_eighth = register_module("to_eighth", make_conv(4 * features, eighth_features, 1));
  eighth_down = register_module("eighth_down", ResidualBlock(eighth_features));
  to_sixteenth =
      register_module("to_sixteenth", make_conv(4 * eighth_features, sixteenth_features, 1));
  if (added > 0)
    from_added = register_module("from_added", make_zero_linear(added, sixteenth_features));
  sixteenth = register_module("sixteenth", ResidualBlocks(sixteenth_features, 3));
  from_sixteenth =
      register_module("from_sixteenth", make_conv(sixteenth_features, 4 * eighth_features, 1));
  eighth_up = register_module("eighth_up", ResidualBlock(eighth_features));
  from_eighth = register_module("from_eighth", make_conv(eighth_features, 4 * features, 1));
  quarter_up = register_module("quarter_up", ResidualBlock(features));
  out =
      register_module("out", make_conv(features, kSteps * (2 + pixels * (channels + 2)), 3, true));
}

std::vector<Tensor> ImageMotionImpl::forward(const Tensor& last, const Tensor& before,
                                             const Tensor& moved, const Tensor& added) {
  const Tensor now = last / kGreyLevels;
  const Tensor change = now - before / kGreyLevels;
  const Tensor expected = (moved - last.unsqueeze(1)).flatten(1, 2) / kGreyLevels;
  const Tensor seen = torch::cat({now, change, change.abs(), expected}, 1);
  const Tensor fine = quarter_down(stem(unshuffled(seen, 4 * unit)));  // [B, M, H/4, W/4]
  const Tensor middle = eighth_down(halved(to_eighth, fine));          // [B, 2M, H/8, W/8]
  Tensor x = halved(to_sixteenth, middle);                             // [B, 4M, H/16, W/16]
  if (from_added) x = with_features(x, from_added(added));
  x = sixteenth(x);
  x = eighth_up(middle + doubled(from_sixteenth, x));  // [B, 2M, H/8, W/8]
  x = quarter_up(fine + doubled(from_eighth, x));      // [B, M, H/4, W/4]
  std::vector<Tensor> images;
  for (const Tensor& step : out(activate(x)).chunk(kSteps, 1)) {
    const Tensor flow = enlarged(step.slice(1, 0, 2), 4 * unit) * (kFlowPixels * unit);
    const Tensor mended = torch::pixel_shuffle(step.slice(1, 2), 4 * unit);
    const Tensor open = torch::sigmoid(mended.slice(1, channels) + kFirstMask);  // [B, 2, H, W]
    const Tensor warped = warp(last, flow);
    const Tensor share = open.slice(1, 1, 2);
    const auto k = static_cast<int64_t>(images.size());
    images.push_back(warped + share * (moved.select(1, k) - warped) +
                     open.slice(1, 0, 1) * mended.slice(1, 0, channels) * kGreyLevels);
  }
  return images;
}

}  // namespace engram::encoders
