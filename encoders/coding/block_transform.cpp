// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/block_transform.h"

#include <algorithm>

#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

constexpr size_t kSide = BlockGrid::kSide;
constexpr size_t kSize = BlockGrid::kCoefficients;

/// Factors are in 1/8192.
constexpr int kFactorBits = 13;

using Block = std::array<int32_t, kSize>;

/// Row u of the cosine transform: kCosines[u][x] = s cos((2x + 1) u pi / 16), rows of length one.
constexpr auto kCosines = [] {
  // cos(i pi / 16) / 2.
  constexpr std::array<int32_t, 9> kHalf{4096, 4017, 3784, 3406, 2896, 2276, 1567, 799, 0};
  std::array<std::array<int32_t, kSide>, kSide> rows{};
  for (size_t u = 0; u < kSide; ++u)
    for (size_t x = 0; x < kSide; ++x) {
      size_t angle = (2 * x + 1) * u % 32;
      angle = std::min(angle, 32 - angle);
      rows[u][x] = u == 0 ? kHalf[4] : angle <= 8 ? kHalf[angle] : -kHalf[16 - angle];
    }
  return rows;
}();

/// Places of a block from low to high frequencies, diagonal by diagonal.
constexpr auto kOrder = [] {
  std::array<size_t, kSize> order{};
  size_t at = 0;
  for (size_t sum = 0; sum < 2 * kSide - 1; ++sum)
    for (size_t i = 0; i <= sum; ++i) {
      const size_t y = sum % 2 == 0 ? sum - i : i;
      if (y < kSide && sum - y < kSide) order[at++] = y * kSide + (sum - y);
    }
  return order;
}();

/// Maps red, green and blue to brightness and two colours: orthogonal rows of length one.
constexpr std::array<std::array<int32_t, 3>, 3> kColours{
    {{4730, 4730, 4730}, {5793, 0, -5793}, {3344, -6689, 3344}}};

int32_t scaled(int32_t sum, int bits) {
  return (sum + (1 << (bits - 1))) >> bits;
}

int32_t clamped(int32_t value) {
  return std::clamp(value, -kMaxCoefficient, kMaxCoefficient);
}

/// Transforms each row of a block and writes it as a column. Applied twice, it transforms rows and
/// columns.
Block transformed(const Block& block) {
  Block result{};
  for (size_t y = 0; y < kSide; ++y)
    for (size_t u = 0; u < kSide; ++u) {
      int32_t sum = 0;
      for (size_t x = 0; x < kSide; ++x) sum += block[y * kSide + x] * kCosines[u][x];
      result[u * kSide + y] = clamped(scaled(sum, kFactorBits));
    }
  return result;
}

Block transformed_back(const Block& block) {
  Block result{};
  for (size_t v = 0; v < kSide; ++v)
    for (size_t x = 0; x < kSide; ++x) {
      int32_t sum = 0;
      for (size_t u = 0; u < kSide; ++u) sum += block[v * kSide + u] * kCosines[u][x];
      result[x * kSide + v] = clamped(scaled(sum, kFactorBits));
    }
  return result;
}

/// Planes of whole blocks. Shape: [planes, rows * 8, columns * 8].
class Planes {
 public:
  explicit Planes(const PixelShape& shape)
      : shape_(shape), grid_(shape), width_(grid_.columns * kSide) {
    values_.resize(grid_.coefficients());
  }

  int32_t& at(size_t plane, size_t y, size_t x) {
    return values_[(plane * grid_.rows * kSide + y) * width_ + x];
  }

  void fill(std::span<const int16_t> differences) {
    for (size_t y = 0; y < grid_.rows * kSide; ++y)
      for (size_t x = 0; x < width_; ++x) {
        const size_t from_y = std::min(y, static_cast<size_t>(shape_.height) - 1);
        const size_t from_x = std::min(x, static_cast<size_t>(shape_.width) - 1);
        const auto pixel = differences.subspan(
            (from_y * static_cast<size_t>(shape_.width) + from_x) * grid_.planes, grid_.planes);
        for (size_t plane = 0; plane < grid_.planes; ++plane)
          at(plane, y, x) = grid_.planes == 3 ? colour(pixel, plane) : pixel[plane] * kUnit;
      }
  }

  [[nodiscard]] std::vector<int16_t> pixels() {
    std::vector<int16_t> result;
    result.reserve(shape_.count());
    for (size_t y = 0; y < static_cast<size_t>(shape_.height); ++y)
      for (size_t x = 0; x < static_cast<size_t>(shape_.width); ++x)
        for (size_t channel = 0; channel < grid_.planes; ++channel)
          result.push_back(static_cast<int16_t>(grid_.planes == 3
                                                    ? channel_of(y, x, channel)
                                                    : scaled(at(channel, y, x), kUnitBits)));
    return result;
  }

  template <typename Work>
  void for_each_block(Work work) {
    size_t index = 0;
    for (size_t plane = 0; plane < grid_.planes; ++plane)
      for (size_t row = 0; row < grid_.rows; ++row)
        for (size_t column = 0; column < grid_.columns; ++column)
          work(index++, &at(plane, row * kSide, column * kSide), width_);
  }

 private:
  static constexpr int kUnitBits = 3;
  static constexpr int kUnit = kCoefficientUnit;
  static_assert(1 << kUnitBits == kUnit);

  static int32_t colour(std::span<const int16_t> pixel, size_t plane) {
    int32_t sum = 0;
    for (size_t i = 0; i < 3; ++i) sum += pixel[i] * kUnit * kColours[plane][i];
    return scaled(sum, kFactorBits);
  }

  int32_t channel_of(size_t y, size_t x, size_t channel) {
    int32_t sum = 0;
    for (size_t plane = 0; plane < 3; ++plane) sum += at(plane, y, x) * kColours[plane][channel];
    return scaled(sum, kFactorBits + kUnitBits);
  }

  PixelShape shape_;
  BlockGrid grid_;
  size_t width_;
  std::vector<int32_t> values_;
};

}  // namespace

std::vector<int16_t> to_coefficients(std::span<const int16_t> differences,
                                     const PixelShape& shape) {
  ENGRAM_CHECK(differences.size() == shape.count() && shape.count() > 0, "{} differences of {}",
               differences.size(), shape.count());
  Planes planes(shape);
  planes.fill(differences);
  std::vector<int16_t> coefficients(BlockGrid(shape).coefficients());
  planes.for_each_block([&](size_t index, const int32_t* first, size_t width) {
    Block block{};
    for (size_t i = 0; i < kSize; ++i) block[i] = first[i / kSide * width + i % kSide];
    block = transformed(transformed(block));
    for (size_t i = 0; i < kSize; ++i)
      coefficients[index * kSize + i] = static_cast<int16_t>(block[kOrder[i]]);
  });
  return coefficients;
}

std::vector<int16_t> from_coefficients(std::span<const int16_t> coefficients,
                                       const PixelShape& shape) {
  ENGRAM_CHECK(coefficients.size() == BlockGrid(shape).coefficients(), "{} coefficients of {}",
               coefficients.size(), BlockGrid(shape).coefficients());
  Planes planes(shape);
  planes.for_each_block([&](size_t index, int32_t* first, size_t width) {
    const auto own = coefficients.subspan(index * kSize, kSize);
    if (std::ranges::all_of(own, [](int16_t value) { return value == 0; })) return;
    Block block{};
    for (size_t i = 0; i < kSize; ++i) block[kOrder[i]] = clamped(own[i]);
    block = transformed_back(transformed_back(block));
    for (size_t i = 0; i < kSize; ++i) first[i / kSide * width + i % kSide] = block[i];
  });
  return planes.pixels();
}

}  // namespace engram::encoders
