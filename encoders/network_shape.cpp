// SPDX-License-Identifier: Apache-2.0
#include "encoders/network_shape.h"

#include <algorithm>

namespace engram::encoders {

namespace {

/// Max side of an image, in units.
constexpr int kMaxUnits = 256;

int padded(int size, int multiple) {
  return (size + multiple - 1) / multiple * multiple;
}

}  // namespace

bool NetworkSizes::is_valid() const {
  return width >= 0 && width <= kMaxWidth && width % 16 == 0 && coarse_channels >= 1 &&
         coarse_channels <= kMaxChannels && fine_channels >= 1 && fine_channels <= kMaxChannels &&
         scenes >= 1 && scenes <= kMaxScenes && conditions >= 0 &&
         conditions <= static_cast<int>(TensorPlan::kMaxNumbers);
}

std::vector<LatentGrid> NetworkShape::grids(size_t image) const {
  const ImageShape& shape = images[image];
  const int coarse = shape.coarse_stride();
  const int fine = shape.fine_stride();
  return {{sizes.coarse_channels, shape.height / coarse, shape.width / coarse},
          {sizes.fine_channels, shape.height / fine, shape.width / fine}};
}

int max_scenes(const ImageShape& image) {
  const int64_t pixels = int64_t{image.channels} * image.height * image.width;
  return static_cast<int>(std::clamp<int64_t>(NetworkSizes::kMaxBackgroundPixels / pixels, 1,
                                              NetworkSizes::kMaxScenes));
}

NetworkShape network_shape(const TensorPlan& plan, const NetworkSizes& sizes) {
  NetworkShape shape;
  shape.sizes = sizes;
  for (const ImageMember& image : plan.images()) {
    ImageShape one{image.channels, 0, 0, 1};
    while (std::max(image.height, image.width) > kMaxUnits * one.unit) one.unit *= 2;
    one.height = padded(image.height, one.coarse_stride());
    one.width = padded(image.width, one.coarse_stride());
    shape.images.push_back(one);
  }
  shape.numbers = static_cast<int>(plan.number_count());
  return shape;
}

}  // namespace engram::encoders
