// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/residual_image.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <optional>

#include "encoders/coding/binary_coder.h"
#include "encoders/coding/byte_stream.h"
#include "encoders/coding/residual_coder.h"
#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

constexpr size_t kTransformSize = BlockGrid::kCoefficients;
/// Price of a bit, in 1/64 of a squared step. At this price squared error and bits of a fine
/// quantiser are in balance.
constexpr int64_t kBitPrice = 8;

/// One way to quantise a block.
struct BlockChoiceOfLevels {
  std::array<int16_t, kTransformSize> levels{};
  bool continues = false;
  int64_t cost = 0;
};

int32_t to_level(int32_t value, int32_t step) {
  // A value is rounded down below three quarters of a step, because zeros and small levels are
  // cheap.
  const int32_t level = (4 * std::abs(value) + step) / (4 * step);
  return std::clamp(value < 0 ? -level : level, -kMaxCoefficient, kMaxCoefficient);
}

/// Approximate number of bits of a level that is not zero.
int64_t bits_of(int32_t level) {
  return 3 + 2 * std::bit_width(static_cast<uint32_t>(std::abs(level)));
}

/// The cheaper choice of coding the differences to `base` (or to zero if it is null) and of coding
/// nothing.
BlockChoiceOfLevels quantised(const int16_t* target, const int16_t* base, int32_t step) {
  BlockChoiceOfLevels choice;
  choice.continues = base != nullptr;
  int64_t left_error = 0, error = 0, bits = 4;
  for (size_t i = 0; i < kTransformSize; ++i) {
    const int32_t difference = int32_t{target[i]} - (base == nullptr ? 0 : base[i]);
    const int32_t level = to_level(difference, step);
    const int64_t rest = int64_t{difference} - int64_t{level} * step;
    choice.levels[i] = static_cast<int16_t>(level);
    left_error += int64_t{difference} * difference;
    error += rest * rest;
    if (level != 0) bits += bits_of(level);
  }
  choice.cost = error + bits * kBitPrice * step * step / 64;
  if (left_error <= choice.cost) {
    choice.levels.fill(0);
    choice.cost = left_error;
  }
  return choice;
}

QuantisedResidual quantised(std::span<const int16_t> target, std::span<const int16_t> last,
                            const BlockGrid& grid, int step) {
  QuantisedResidual image(grid);
  image.step = step;
  for (size_t block = 0; block < grid.blocks(); ++block) {
    const auto* own = target.data() + block * kTransformSize;
    const auto* before = last.data() + block * kTransformSize;
    BlockChoiceOfLevels best = quantised(own, nullptr, residual_step(step));
    if (std::any_of(before, before + kTransformSize, [](int16_t value) { return value != 0; })) {
      BlockChoiceOfLevels continued = quantised(own, before, residual_step(step));
      if (continued.cost < best.cost) best = continued;
    }
    image.continues[block] = best.continues ? 1 : 0;
    std::ranges::copy(best.levels,
                      image.levels.begin() + static_cast<ptrdiff_t>(block * kTransformSize));
  }
  return image;
}

uint64_t squared_error(std::span<const uint8_t> image, std::span<const uint8_t> recorded) {
  uint64_t sum = 0;
  for (size_t i = 0; i < image.size(); ++i) {
    const int difference = int{image[i]} - int{recorded[i]};
    sum += static_cast<uint64_t>(difference * difference);
  }
  return sum;
}

/// The code of a row, if it has one.
using RowCode = std::optional<std::span<const std::byte>>;

Result<std::vector<RowCode>> codes_of(std::span<const std::byte> bytes, size_t rows) {
  ByteReader reader(bytes);
  std::vector<uint64_t> sizes;
  for (size_t row = 0; row < rows; ++row)
    sizes.push_back(static_cast<uint64_t>(reader.get_varint()));
  if (reader.failed()) return data_loss("residuals: end within the sizes of {} rows", rows);
  bytes = reader.rest();
  std::vector<RowCode> codes;
  for (const uint64_t size : sizes) {
    codes.emplace_back();
    if (size == 0) continue;
    if (size - 1 > bytes.size())
      return data_loss("residuals: found a row of {} bytes, needs at most {}", size - 1,
                       bytes.size());
    codes.back() = bytes.first(size - 1);
    bytes = bytes.subspan(size - 1);
  }
  if (!bytes.empty())
    return data_loss("residuals: found {} bytes behind the last of {} rows", bytes.size(), rows);
  return codes;
}

}  // namespace

ResidualEncoder::ResidualEncoder(const PixelShape& shape)
    : shape_(shape), grid_(shape), coder_(std::make_unique<ResidualCoder>(grid_)) {}
ResidualEncoder::~ResidualEncoder() = default;

bool ResidualEncoder::add(std::span<const uint8_t> decoded, std::span<const uint8_t> recorded,
                          uint64_t max_error) {
  ENGRAM_CHECK(decoded.size() == shape_.count() && recorded.size() == shape_.count(),
               "images of {} and {} elements, needs {}", decoded.size(), recorded.size(),
               shape_.count());
  if (squared_error(decoded, recorded) <= max_error) {
    codes_.emplace_back();
    return true;
  }
  std::vector<int16_t> missing(shape_.count());
  for (size_t i = 0; i < missing.size(); ++i)
    missing[i] = static_cast<int16_t>(recorded[i] - decoded[i]);
  const std::vector<int16_t> target = to_coefficients(missing, shape_);
  std::optional<QuantisedResidual> best;
  int good = -1, bad = kResidualSteps;  // Steps that are known to keep and to miss the bound.
  while (bad - good > 1) {
    const int step = (good + bad) / 2;
    QuantisedResidual image = quantised(target, coder_->last(), grid_, step);
    std::vector<uint8_t> corrected(decoded.begin(), decoded.end());
    add_residual(coder_->after(image), shape_, corrected);
    const bool is_good = squared_error(corrected, recorded) <= max_error;
    (is_good ? good : bad) = step;
    if (is_good) best = std::move(image);
  }
  if (!best) return false;
  BinaryEncoder encoder;
  coder_->code(encoder, *best);
  codes_.emplace_back(encoder.finish());
  return true;
}

std::vector<std::byte> ResidualEncoder::finish() const {
  if (std::ranges::none_of(codes_, [](const auto& code) { return code.has_value(); })) return {};
  ByteWriter writer;
  for (const auto& code : codes_)
    writer.put_varint(code ? static_cast<int64_t>(code->size()) + 1 : 0);
  std::vector<std::byte> bytes = writer.take();
  for (const auto& code : codes_)
    if (code) bytes.insert(bytes.end(), code->begin(), code->end());
  return bytes;
}

Result<ResidualRows> decode_residuals(std::span<const std::byte> bytes, const PixelShape& shape,
                                      size_t rows, size_t wanted) {
  ENGRAM_ASSIGN_OR_RETURN(const auto codes, codes_of(bytes, rows));
  ResidualRows residuals(wanted);
  const BlockGrid grid(shape);
  ResidualCoder coder(grid);
  for (size_t row = 0; row < wanted; ++row) {
    if (!codes[row]) continue;
    BinaryDecoder decoder(*codes[row]);
    QuantisedResidual image(grid);
    coder.code(decoder, image);
    residuals[row] = coder.last();
  }
  return residuals;
}

Result<std::vector<std::optional<uint64_t>>> residual_bytes(std::span<const std::byte> bytes,
                                                            size_t rows) {
  ENGRAM_ASSIGN_OR_RETURN(const auto codes, codes_of(bytes, rows));
  std::vector<std::optional<uint64_t>> sizes(rows);
  for (size_t row = 0; row < rows; ++row)
    if (codes[row]) sizes[row] = codes[row]->size();
  return sizes;
}

void add_residual(std::span<const int16_t> residual, const PixelShape& shape,
                  std::span<uint8_t> image) {
  const std::vector<int16_t> pixels = from_coefficients(residual, shape);
  for (size_t i = 0; i < image.size(); ++i)
    image[i] = static_cast<uint8_t>(std::clamp(image[i] + pixels[i], 0, 255));
}

idf::NdArray with_residual(const idf::NdArray& image, std::span<const int16_t> residual,
                           const PixelShape& shape) {
  const auto decoded = image.values<uint8_t>();
  std::vector<uint8_t> pixels(decoded.begin(), decoded.end());
  add_residual(residual, shape, pixels);
  return idf::NdArray::take<uint8_t>(image.shape(), std::move(pixels));
}

}  // namespace engram::encoders
