// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/residual_coder.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "encoders/coding/binary_coder.h"

namespace engram::encoders {

namespace {

constexpr BitProbability kEvenOdds = 1u << 15;

size_t band_of(size_t at) {
  constexpr std::array<size_t, 7> kFirst{1, 3, 6, 10, 15, 21, 36};
  return static_cast<size_t>(std::ranges::upper_bound(kFirst, at) - kFirst.begin());
}

bool has_any(const int16_t* block) {
  return std::any_of(block, block + BlockGrid::kCoefficients,
                     [](int16_t value) { return value != 0; });
}

size_t magnitude_at(const int16_t* levels, size_t at) {
  return levels == nullptr ? 0 : static_cast<size_t>(std::abs(int{levels[at]}));
}

}  // namespace

int32_t residual_step(int index) {
  constexpr std::array<int32_t, 8> kEighths{1024, 1117, 1218, 1328, 1448, 1579, 1722, 1878};
  const int32_t doubled = kEighths[static_cast<size_t>(index % 8)] << (index / 8);
  return (doubled + 128) >> 8;
}

ResidualCoder::ResidualCoder(const BlockGrid& grid)
    : grid_(grid),
      last_(grid.coefficients()),
      has_last_(grid.blocks()),
      ends_(grid.blocks()),
      modes_(grid.blocks()),
      coded_({kPlanes * 3, kPlanes * 4, kPlanes * 3 * 2, 8}, 1),
      zero_({kPlanes * kSize, kBands * 16, kBands * kPlanes * 12, kBands * 10, kBands * 32},
            kBands),
      end_({kPlanes * kSize, kBands * 8, kPlanes * 9}, 1),
      larger_({kLongest * kBands, kLongest * 16, kLongest * 10}, 1) {}

ResidualCoder::Place ResidualCoder::place_of(const QuantisedResidual& image, size_t plane,
                                             size_t row, size_t column) const {
  Place place;
  place.plane = std::min(plane, kPlanes - 1);
  place.block = (plane * grid_.rows + row) * grid_.columns + column;
  const auto levels = [&](size_t block) { return image.levels.data() + block * kSize; };
  if (column > 0) {
    place.left = levels(place.block - 1);
    place.left_end = ends_[place.block - 1];
    place.left_mode = modes_[place.block - 1];
  }
  if (row > 0) {
    place.above = levels(place.block - grid_.columns);
    place.above_end = ends_[place.block - grid_.columns];
    place.above_mode = modes_[place.block - grid_.columns];
  }
  if (plane > 0) {
    const size_t before = place.block - grid_.rows * grid_.columns;
    place.before = levels(before);
    place.before_mode = modes_[before];
    place.before_end = ends_[before];
  }
  return place;
}

size_t ResidualCoder::last_class(size_t index) const {
  const int32_t last = std::abs(int32_t{last_[index]});
  if (2 * last < step_) return last == 0 ? 0 : 1;
  return last < step_ ? 2 : last < 2 * step_ ? 3 : 4;
}

ResidualCoder::Neighbourhood ResidualCoder::around(const Place& place, const int16_t* levels,
                                                   size_t at, bool continues) const {
  Neighbourhood known;
  known.beside = std::min<size_t>(magnitude_at(place.left, at) + magnitude_at(place.above, at), 3);
  const size_t nearest = at > 0 ? magnitude_at(levels, at - 1) : 0;
  known.near = std::min<size_t>(nearest + (at > 1 ? magnitude_at(levels, at - 2) : 0), 3);
  known.before = std::min<size_t>(magnitude_at(place.before, at), 2);
  known.last = last_class(place.block * kSize + at) + (continues ? 5 : 0);
  return known;
}

template <typename Port>
int ResidualCoder::code_magnitude(Port& port, size_t band, const Neighbourhood& known,
                                  int magnitude) {
  for (size_t length = 0; length < kLongest; ++length) {
    const auto is_larger = magnitude > static_cast<int>(length) + 1;
    if (!larger_.code(port,
                      {length * kBands + band, length * 16 + known.beside * 4 + known.near,
                       length * 10 + known.last},
                      0, is_larger))
      return static_cast<int>(length) + 1;
  }
  constexpr int64_t kBeyond = kLongest + 1;
  const int64_t rest = rest_.code(port, magnitude - kBeyond);
  // Hostile bytes may decode to any integer, so it is clamped.
  return static_cast<int>(kBeyond + std::clamp<int64_t>(rest, 0, kMaxCoefficient - kBeyond));
}

template <typename Port>
void ResidualCoder::code_levels(Port& port, const Place& place, bool continues, int16_t* levels) {
  size_t end = 0;
  for (size_t at = kSize; at > 0 && end == 0; --at)
    if (levels[at - 1] != 0) end = at;
  size_t count = 0;
  size_t zeros = 0;
  for (size_t at = 0; at < kSize; ++at) {
    const Neighbourhood known = around(place, levels, at, continues);
    const size_t band = band_of(at);
    const bool is_zero =
        zero_.code(port,
                   {place.plane * kSize + at, band * 16 + known.beside * 4 + known.near,
                    ((band * kPlanes + place.plane) * 3 + known.before) * 4 + known.near,
                    band * 10 + known.last,
                    (band * 4 + std::min<size_t>(count, 3)) * 8 + std::min<size_t>(zeros, 7)},
                   band, levels[at] == 0);
    zeros = is_zero ? zeros + 1 : 0;
    if (is_zero) continue;
    // Signs are coded as equally likely: no context predicts them.
    const bool is_negative = port.code(levels[at] < 0, kEvenOdds);
    const int magnitude = code_magnitude(port, band, known, std::abs(int{levels[at]}));
    levels[at] = static_cast<int16_t>(is_negative ? -magnitude : magnitude);
    ends_[place.block] = static_cast<uint8_t>(at + 1);
    if (at + 1 == kSize) return;
    const auto reach = [at](size_t other) -> size_t {
      return other == 0 ? 0 : other > at + 1 ? 2 : 1;
    };
    if (end_.code(port,
                  {place.plane * kSize + at, band * 8 + std::min<size_t>(count, 7),
                   (place.plane * 3 + reach(place.left_end)) * 3 + reach(place.above_end)},
                  0, end == at + 1))
      return;
    ++count;
  }
}

template <typename Port>
void ResidualCoder::code_block(Port& port, const Place& place, QuantisedResidual& image) {
  const size_t block = place.block;
  int16_t* levels = image.levels.data() + block * kSize;
  bool continues = false;
  modes_[block] = ends_[block] = 0;
  // Without a last residual to continue from, the block has no choice and the bit is not coded.
  if (has_last_[block] != 0) {
    AdaptiveBit& bit = continues_[(place.left_mode * 3 + place.above_mode) * 3 + place.before_mode];
    continues = bit.code(port, image.continues[block] != 0);
    modes_[block] = continues ? 2 : 1;
  }
  image.continues[block] = continues ? 1 : 0;
  const size_t beside = (place.left_end > 0 ? 1 : 0) + (place.above_end > 0 ? 1 : 0);
  const size_t before = magnitude_at(place.before, 0) > 0 ? 2 : place.before_end > 0 ? 1 : 0;
  const bool is_coded =
      coded_.code(port,
                  {place.plane * 3 + beside, place.plane * 3 + modes_[block],
                   (place.plane * 3 + before) * 2 + (beside > 0 ? 1 : 0),
                   std::min<size_t>(std::bit_width(place.left_end + place.above_end), 7)},
                  0, has_any(levels));
  if (is_coded) code_levels(port, place, continues, levels);
}

void ResidualCoder::add_to(std::vector<int16_t>& last, const QuantisedResidual& image,
                           size_t block) const {
  const int32_t step = residual_step(image.step);
  const auto own = std::span(last).subspan(block * kSize, kSize);
  const auto levels = std::span(image.levels).subspan(block * kSize, kSize);
  if (image.continues[block] == 0) std::ranges::fill(own, int16_t{0});
  if (!has_any(levels.data())) return;
  for (size_t i = 0; i < kSize; ++i)
    own[i] = static_cast<int16_t>(
        std::clamp(own[i] + levels[i] * step, -kMaxCoefficient, kMaxCoefficient));
}

std::vector<int16_t> ResidualCoder::after(const QuantisedResidual& image) const {
  std::vector<int16_t> sum = last_;
  for (size_t block = 0; block < grid_.blocks(); ++block) add_to(sum, image, block);
  return sum;
}

template <typename Port>
void ResidualCoder::code(Port& port, QuantisedResidual& image) {
  image.step = std::min(
      static_cast<int>(port.code_even(static_cast<uint32_t>(image.step), kResidualStepBits)),
      kResidualSteps - 1);
  step_ = residual_step(image.step);
  for (size_t plane = 0; plane < grid_.planes; ++plane)
    for (size_t row = 0; row < grid_.rows; ++row)
      for (size_t column = 0; column < grid_.columns; ++column)
        code_block(port, place_of(image, plane, row, column), image);
  for (size_t block = 0; block < grid_.blocks(); ++block) {
    add_to(last_, image, block);
    has_last_[block] = has_any(last_.data() + block * kSize) ? 1 : 0;
  }
}

template void ResidualCoder::code(BinaryEncoder&, QuantisedResidual&);
template void ResidualCoder::code(BinaryDecoder&, QuantisedResidual&);

}  // namespace engram::encoders
