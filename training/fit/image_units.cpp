// SPDX-License-Identifier: Apache-2.0
#include "training/fit/image_units.h"

namespace engram::training {

double size_in_usual_images(const encoders::NetworkShape& shape) {
  constexpr double kUsualElements = 128 * 128 * 3;
  double elements = 0;
  for (const auto& image : shape.images)
    elements += static_cast<double>(image.channels) * image.height * image.width;
  return elements / kUsualElements;
}

}  // namespace engram::training
