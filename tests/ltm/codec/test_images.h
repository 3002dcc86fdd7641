// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {

inline idf::NdArray random_array(idf::ElementType type, const idf::Shape& shape,
                                 RandomValues& random) {
  const size_t size = *idf::size_bytes(type, shape);
  std::vector<uint64_t> words((size + 7) / 8);
  for (uint64_t& word : words) word = random.bits();
  return *idf::NdArray::create(type, shape, Buffer::take(std::move(words)).slice(0, size));
}

/// Waves of light that move with `time`, different in each channel.
inline idf::NdArray smooth_image(int64_t height, int64_t width, int64_t channels, int time = 0) {
  std::vector<double> across;
  for (int64_t x = 0; x < width; ++x)
    for (int64_t c = 0; c < channels; ++c)
      across.push_back(60 *
                       std::sin(static_cast<double>(x + 2 * time) / 37 + static_cast<double>(c)));
  std::vector<uint8_t> pixels;
  pixels.reserve(static_cast<size_t>(height) * across.size());
  for (int64_t y = 0; y < height; ++y) {
    const double down = 50 * std::cos(static_cast<double>(y) / 29);
    for (const double light : across) pixels.push_back(static_cast<uint8_t>(128 + light + down));
  }
  return idf::NdArray::take({height, width, channels}, std::move(pixels));
}

/// Of two arrays of uint8. Unit: dB; infinity where they are equal.
inline double psnr_db(const idf::NdArray& a, const idf::NdArray& b) {
  double sum = 0;
  const auto x = a.values<uint8_t>();
  const auto y = b.values<uint8_t>();
  for (size_t i = 0; i < x.size(); ++i) sum += (x[i] - y[i]) * (x[i] - y[i]);
  if (sum == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(x.size()) / sum);
}

}  // namespace engram::ltm
