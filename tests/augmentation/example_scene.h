// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::augmentation {

/// A gradient with a bright square in the middle, which `labels` calls 3. Shape: [height, width,
/// 3].
inline idf::NdArray example_image(int height, int width) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool is_square =
          4 * y >= height && 4 * y < 3 * height && 4 * x >= width && 4 * x < 3 * width;
      pixels.push_back(static_cast<uint8_t>(is_square ? 200 : x * 255 / width));
      pixels.push_back(static_cast<uint8_t>(is_square ? 180 : y * 255 / height));
      pixels.push_back(static_cast<uint8_t>(is_square ? 40 : (x + y) % 256));
    }
  return idf::NdArray::take({height, width, 3}, std::move(pixels));
}

inline idf::NdArray example_labels(int height, int width) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      pixels.push_back(
          4 * y >= height && 4 * y < 3 * height && 4 * x >= width && 4 * x < 3 * width ? 3 : 0);
  return idf::NdArray::take({height, width, 1}, std::move(pixels));
}

inline idf::NdArray example_depth(int height, int width) {
  std::vector<uint16_t> pixels;
  for (int i = 0; i < height * width; ++i) pixels.push_back(static_cast<uint16_t>(1000 + i % 500));
  return idf::NdArray::take({height, width, 1}, std::move(pixels));
}

/// {"image", "labels", "depth", "corner": [x, y], "width_m"}: the corner is the square's.
inline idf::Data example_value(int height = 32, int width = 48) {
  return idf::Dict{{"image", example_image(height, width)},
                   {"labels", example_labels(height, width)},
                   {"depth", example_depth(height, width)},
                   {"corner", idf::NdArray::take<double>({2}, {width / 4.0, height / 4.0})},
                   {"width_m", 0.25}};
}

}  // namespace engram::augmentation
