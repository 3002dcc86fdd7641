// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/byte_model.h"

#include <algorithm>
#include <bit>

namespace engram::encoders {

namespace {

constexpr int kMixerRate = 14;

}  // namespace

size_t ByteModel::class_of(uint32_t sixteenths) {
  const auto width = static_cast<size_t>(std::bit_width(sixteenths));
  const size_t half = width >= 2 ? (sixteenths >> (width - 2)) & 1 : 0;
  return std::min(2 * width + half, kClasses - 1);
}

ByteModel::ByteModel()
    : odds_(odds_table()), bits_(kContexts * kClasses * kNodes), mixers_(kNodes) {}

template <typename Port>
bool ByteModel::code_mixed(Port& port, const Contexts& contexts, size_t node, bool bit) {
  std::array<OddsBit*, kContexts> estimates{};
  std::array<LogOdds, kContexts + 1> odds{};
  for (size_t i = 0; i < kContexts; ++i) {
    estimates[i] = &bits_[(i * kClasses + contexts[i]) * kNodes + node];
    odds[i] = estimates[i]->odds();
  }
  odds[kContexts] = 256;
  const BitProbability one = mixers_[node].mix(odds);
  bit = port.code(bit, one);
  mixers_[node].update(odds, one, bit, kMixerRate);
  for (OddsBit* estimate : estimates) estimate->update(bit, odds_);
  return bit;
}

template <typename Port>
uint32_t ByteModel::code_low_bits(Port& port, size_t side, uint32_t width, uint32_t magnitude) {
  uint32_t result = 1;
  size_t node = 0;
  for (uint32_t left = width - 1; left > 0; --left) {
    const bool bit = ((magnitude >> (left - 1)) & 1) != 0;
    AdaptiveBit& estimate = high_[(side * kWidths + width) * kHigh + node];
    const bool is_modelled = width - left <= 2;
    const bool coded = is_modelled ? estimate.code(port, bit) : port.code(bit, 1u << 15);
    node = coded ? 2 : 1;
    result = (result << 1) | (coded ? 1 : 0);
  }
  return result;
}

template <typename Port>
int ByteModel::code(Port& port, const Contexts& contexts, int value) {
  const bool is_negative = sign_[contexts.front()].code(port, value < 0);
  const size_t side = is_negative ? 1 : 0;
  // Magnitudes count from 0 for positive and from -1 for negative values, so both fit 7 bits.
  const auto magnitude = static_cast<uint32_t>(is_negative ? ~value : value) & 0x7f;
  auto width = static_cast<size_t>(std::bit_width(magnitude));
  size_t node = 1;
  for (int bit = 2; bit >= 0; --bit)
    node = 2 * node +
           (code_mixed(port, contexts, side * kWidths + node, ((width >> bit) & 1) != 0) ? 1 : 0);
  width = node - kWidths;
  if (width == 0) return is_negative ? -1 : 0;
  const auto decoded =
      static_cast<int>(code_low_bits(port, side, static_cast<uint32_t>(width), magnitude));
  return is_negative ? ~decoded : decoded;
}

template int ByteModel::code(BinaryEncoder&, const Contexts&, int);
template int ByteModel::code(BinaryDecoder&, const Contexts&, int);

}  // namespace engram::encoders
