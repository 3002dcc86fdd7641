// SPDX-License-Identifier: Apache-2.0
#include "encoders/view.h"

namespace engram::encoders {

using torch::Tensor;

PlaceFeaturesImpl::PlaceFeaturesImpl(const ImageShape& shape, const NetworkSizes& sizes)
    : unit(shape.unit) {
  const int sixteenth_features = sizes.width;
  const int eighth_features = sizes.width * 3 / 4;
  const int quarter_features = sizes.width * 3 / 8;
  const int hidden = sizes.width / 2;
  const int height = shape.height / unit;
  const int width = shape.width / unit;
  const auto place = [&](int64_t scenes, int features, int stride) {
    return torch::zeros({scenes, features, height / stride, width / stride});
  };
  // The order is that of the tensors in a model file (layers.h).
  sixteenth_by_heart =
      register_parameter("sixteenth_by_heart", place(sizes.scenes, sixteenth_features, 16));
  eighth_by_heart = register_parameter("eighth_by_heart", place(1, eighth_features, 8));
  quarter_by_heart = register_parameter("quarter_by_heart", place(1, quarter_features, 4));
  stem = register_module("stem", make_conv(16 * unit * unit * shape.channels, quarter_features, 3));
  quarter = register_module("quarter", ResidualBlock(quarter_features));
  to_eighth = register_module("to_eighth", make_conv(4 * quarter_features, hidden, 1));
  eighth = register_module("eighth", ResidualBlock(hidden));
  out_eighth = register_module("out_eighth", make_conv(hidden, eighth_features, 1));
  to_sixteenth = register_module("to_sixteenth", make_conv(4 * hidden, sixteenth_features, 1));
}

View PlaceFeaturesImpl::forward(const Tensor& background, const Tensor& scene) {
  const Tensor is_known = (scene >= 0).to(torch::kFloat32).reshape({-1, 1, 1, 1});
  const Tensor q =
      quarter(activate(stem(unshuffled(background, 4 * unit))));  // [B, 3F/8, H/4, W/4]
  const Tensor e = eighth(activate(halved(to_eighth, q)));        // [B, F/2, H/8, W/8]
  const Tensor s = halved(to_sixteenth, e);                       // [B, F, H/16, W/16]
  return {background, s + sixteenth_by_heart.index_select(0, scene.clamp_min(0)) * is_known,
          out_eighth(e) + eighth_by_heart * is_known, q + quarter_by_heart * is_known};
}

}  // namespace engram::encoders
