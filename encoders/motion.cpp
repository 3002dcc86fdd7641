// SPDX-License-Identifier: Apache-2.0
#include "encoders/motion.h"

namespace engram::encoders {

using torch::Tensor;

namespace {

/// Pixels of an image of one unit that a flow of one moves by.
constexpr double kFlowPixels = 8.0;
/// Logit that masks and shares start with: 27 % open.
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
  // Places are told from -1 to 1, edges of pixels at both ends.
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
  const int a = features;
  const int b = 2 * features;
  const int c = 4 * features;
  const int pixels = 16 * unit * unit;
  stem = register_module("stem", make_conv((3 + kSteps) * channels * pixels, a, 3));
  quarter_1 = register_module("quarter_1", ResidualBlock(a));
  to_eighth = register_module("to_eighth", make_conv(4 * a, b, 1));
  eighth_1 = register_module("eighth_1", ResidualBlock(b));
  to_sixteenth = register_module("to_sixteenth", make_conv(4 * b, c, 1));
  if (added > 0) from_added = register_module("from_added", make_zero_linear(added, c));
  sixteenth_1 = register_module("sixteenth_1", ResidualBlock(c));
  sixteenth_2 = register_module("sixteenth_2", ResidualBlock(c));
  sixteenth_3 = register_module("sixteenth_3", ResidualBlock(c));
  from_sixteenth = register_module("from_sixteenth", make_conv(c, 4 * b, 1));
  eighth_2 = register_module("eighth_2", ResidualBlock(b));
  from_eighth = register_module("from_eighth", make_conv(b, 4 * a, 1));
  quarter_2 = register_module("quarter_2", ResidualBlock(a));
  out = register_module("out", make_conv(a, kSteps * (2 + pixels * (channels + 2)), 3, true));
}

std::vector<Tensor> ImageMotionImpl::forward(const Tensor& last, const Tensor& before,
                                             const Tensor& moved, const Tensor& added) {
  const Tensor now = last / kGreyLevels;
  const Tensor change = now - before / kGreyLevels;
  const Tensor expected = (moved - last.unsqueeze(1)).flatten(1, 2) / kGreyLevels;
  const Tensor seen = torch::cat({now, change, change.abs(), expected}, 1);
  const Tensor q = quarter_1(stem(unshuffled(seen, 4 * unit)));  // [B, F, H/4, W/4]
  const Tensor e = eighth_1(halved(to_eighth, q));               // [B, 2F, H/8, W/8]
  Tensor x = halved(to_sixteenth, e);                            // [B, 4F, H/16, W/16]
  if (from_added) x = with_features(x, from_added(added));
  x = sixteenth_3(sixteenth_2(sixteenth_1(x)));
  x = eighth_2(e + doubled(from_sixteenth, x));
  x = quarter_2(q + doubled(from_eighth, x));
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
