// SPDX-License-Identifier: Apache-2.0
#include "training/fit/view_change.h"

#include <algorithm>
#include <cmath>

namespace engram::training {

using torch::Tensor;

namespace {

/// Max shift of images, relative to their side.
constexpr double kMaxShift = 0.09;
/// Max change of contrast, as a factor, and of brightness, in grey levels.
constexpr double kMaxContrast = 0.15;
constexpr double kMaxBrightness = 12.0;

double uniform(double max) {
  return (torch::rand({1}, torch::kFloat64).item<double>() * 2 - 1) * max;
}

}  // namespace

ViewChange ViewChange::draw(bool may_mirror) {
  ViewChange change;
  change.right = uniform(kMaxShift);
  change.down = uniform(kMaxShift);
  change.contrast = 1 + uniform(kMaxContrast);
  change.brightness = uniform(kMaxBrightness);
  change.is_mirrored = may_mirror && uniform(1) > 0;
  return change;
}

Tensor ViewChange::of(const Tensor& images) const {
  namespace F = torch::nn::functional;
  const auto pixels = [&](double share, int dim) {
    return static_cast<int64_t>(std::lround(share * static_cast<double>(images.size(dim))));
  };
  const int64_t x = pixels(right, 3);
  const int64_t y = pixels(down, 2);
  const auto pad = std::max<int64_t>(1, std::max(std::abs(x), std::abs(y)));
  const Tensor wide =
      F::pad(images, F::PadFuncOptions({pad, pad, pad, pad}).mode(torch::kReplicate));
  const Tensor shifted =
      wide.slice(2, pad + y, pad + y + images.size(2)).slice(3, pad + x, pad + x + images.size(3));
  return (is_mirrored ? shifted.flip(3) : shifted) * contrast + brightness;
}

}  // namespace engram::training
