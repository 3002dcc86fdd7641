// SPDX-License-Identifier: Apache-2.0
#include "encoders/view.h"

namespace engram::encoders {

using torch::Tensor;

PlaceFeaturesImpl::PlaceFeaturesImpl(const ImageShape& shape, const NetworkSizes& sizes)
    : unit(shape.unit) {
  const int a = sizes.width;
  const int b = a * 3 / 4;
  const int c = a * 3 / 8;
  const int hidden = a / 2;
  const int height = shape.height / unit;
  const int width = shape.width / unit;
  const auto place = [&](int64_t scenes, int features, int stride) {
    return torch::zeros({scenes, features, height / stride, width / stride});
  };
  place_16 = register_parameter("place_16", place(sizes.scenes, a, 16));
  place_8 = register_parameter("place_8", place(1, b, 8));
  place_4 = register_parameter("place_4", place(1, c, 4));
  stem = register_module("stem", make_conv(16 * unit * unit * shape.channels, c, 3));
  quarter = register_module("quarter", ResidualBlock(c));
  to_eighth = register_module("to_eighth", make_conv(4 * c, hidden, 1));
  eighth = register_module("eighth", ResidualBlock(hidden));
  out_eighth = register_module("out_eighth", make_conv(hidden, b, 1));
  to_sixteenth = register_module("to_sixteenth", make_conv(4 * hidden, a, 1));
}

View PlaceFeaturesImpl::forward(const Tensor& background, const Tensor& scene) {
  const Tensor is_known = (scene >= 0).to(torch::kFloat32).reshape({-1, 1, 1, 1});
  const Tensor q =
      quarter(activate(stem(unshuffled(background, 4 * unit))));  // [B, 3F/8, H/4, W/4]
  const Tensor e = eighth(activate(halved(to_eighth, q)));        // [B, F/2, H/8, W/8]
  const Tensor s = halved(to_sixteenth, e);                       // [B, F, H/16, W/16]
  return {background, s + place_16.index_select(0, scene.clamp_min(0)) * is_known,
          out_eighth(e) + place_8 * is_known, q + place_4 * is_known};
}

}  // namespace engram::encoders
