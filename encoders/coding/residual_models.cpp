// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_row_coder.h"

namespace engram::encoders {

namespace {

constexpr int kResidualMixerRate = 16;
/// Number of bits that a stored start counts as.
constexpr int kScaleTrust = 60;
constexpr int kChannelTrust = 16;
constexpr int kMaxWidth = 40;

// Nodes are the modelled bits: whether the residual is zero, whether it is negative, whether the
// magnitude has more bits (ten nodes), its first bit below the highest by width (four), and the
// other bits.
constexpr size_t kZeroNode = 0, kSignNode = 1, kWidthNode = 2, kFirstBitNode = 12, kOtherNode = 16;
constexpr int kNoChannelNode = -1;

AdaptiveBit start_of(int8_t odds, int seen) {
  return {squash(LogOdds{odds} * 16), seen};
}

int8_t stored(const AdaptiveBit& bit) {
  return static_cast<int8_t>(std::clamp(log_odds(bit.one()) / 16, -127, 127));
}

/// Class of the distance from the prediction to the last value; `offset` is in 1/16 of a step.
size_t hold_class(int64_t offset) {
  const int64_t size = offset < 0 ? -offset : offset;
  if (size < 4) return 0;
  const size_t distance = size < 12 ? 1 : size < 32 ? 2 : 3;
  return offset < 0 ? distance + 3 : distance;
}

/// 2^31 times the share of residuals whose product with `sign` is above `magnitude` - 1/2.
uint64_t share(const Estimates& estimates, size_t i, int sign, int64_t magnitude) {
  const int64_t place = std::clamp<int64_t>((2 * magnitude - 1) * 8 - sign * estimates.offset[i],
                                            -(int64_t{1} << 36), int64_t{1} << 36);
  return share_above(place * 2 * inverse_power(estimates.scale[i]) / (1 << 20));
}

}  // namespace

ResidualModels::ResidualModels(const NumberModel& model) {
  for (const int8_t odds : model.scale_starts) by_scale_.push_back(start_of(odds, kScaleTrust));
  for (const int8_t odds : model.hold_starts) by_hold_.push_back(start_of(odds, kScaleTrust));
  for (const int8_t odds : model.channel_starts)
    by_channel_.push_back(start_of(odds, kChannelTrust));
  for (size_t set = 0; set < 2; ++set)
    for (size_t node = 0; node < kNumberNodes; ++node)
      mixers_[set][node] = Mixer<kMixerInputs>(model.mixers[set][node]);
}

void ResidualModels::store(NumberModel& model) const {
  for (size_t i = 0; i < by_scale_.size(); ++i) model.scale_starts[i] = stored(by_scale_[i]);
  for (size_t i = 0; i < by_hold_.size(); ++i) model.hold_starts[i] = stored(by_hold_[i]);
  for (size_t i = 0; i < by_channel_.size(); ++i) model.channel_starts[i] = stored(by_channel_[i]);
  for (size_t set = 0; set < 2; ++set)
    for (size_t node = 0; node < kNumberNodes; ++node)
      model.mixers[set][node] = mixers_[set][node].weights();
}

template <typename Port>
bool ResidualModels::code_bit(Port& port, const Place& place, size_t node, int channel_node,
                              const std::array<uint64_t, kEstimates>& part,
                              const std::array<uint64_t, kEstimates>& rest, bool bit) {
  std::array<LogOdds, kMixerInputs> odds{};
  for (size_t i = 0; i < kEstimates; ++i) odds[i] = log_odds(part[i], rest[i]);
  AdaptiveBit& by_scale = by_scale_[node * kScaleClasses + place.scale_class];
  AdaptiveBit* by_channel =
      channel_node == kNoChannelNode
          ? nullptr
          : &by_channel_[place.channel * kChannelNodes + static_cast<size_t>(channel_node)];
  AdaptiveBit& by_hold = by_hold_[node * kHoldClasses + place.hold_class];
  odds[kEstimates] = log_odds(by_scale.one());
  odds[kEstimates + 1] = by_channel == nullptr ? 0 : log_odds(by_channel->one());
  odds[kEstimates + 2] = log_odds(by_hold.one());
  odds[kEstimates + 3] = 256;
  Mixer<kMixerInputs>& mixer = mixers_[place.is_first ? 0 : 1][node];
  const BitProbability one = mixer.mix(odds);
  bit = port.code(bit, one);
  mixer.update(odds, one, bit, kResidualMixerRate);
  by_scale.update(bit);
  by_hold.update(bit);
  if (by_channel != nullptr) by_channel->update(bit);
  return bit;
}

template <typename Port>
int64_t ResidualModels::code_magnitude(Port& port, const Place& place, int sign,
                                       int64_t magnitude) {
  std::array<uint64_t, kEstimates> part{}, rest{};
  /// Fills the shares of [middle, end) and [begin, middle). An `end` of zero is infinity.
  const auto split = [&](int64_t begin, int64_t middle, int64_t end) {
    for (size_t i = 0; i < kEstimates; ++i) {
      const uint64_t low = share(*place.estimates, i, sign, begin);
      const uint64_t mid = share(*place.estimates, i, sign, middle);
      const uint64_t high = end == 0 ? 0 : share(*place.estimates, i, sign, end);
      part[i] = mid - high;
      rest[i] = low - mid;
    }
  };
  int width = 0;
  for (; width < kMaxWidth; ++width) {
    const int64_t begin = int64_t{1} << width;
    split(begin, 2 * begin, 0);
    const size_t node = kWidthNode + std::min<size_t>(static_cast<size_t>(width), 9);
    const int channel_node = 4 + std::min(width, 2);
    if (!code_bit(port, place, node, channel_node, part, rest, magnitude >= 2 * begin)) break;
  }
  int64_t begin = int64_t{1} << width;
  for (int bit = width - 1; bit >= 0; --bit) {
    const int64_t half = int64_t{1} << bit;
    split(begin, begin + half, begin + 2 * half);
    const size_t node = bit == width - 1
                            ? kFirstBitNode + std::min<size_t>(static_cast<size_t>(width - 1), 3)
                            : kOtherNode;
    if (code_bit(port, place, node, kNoChannelNode, part, rest, magnitude >= begin + half))
      begin += half;
  }
  return begin;
}

template <typename Port>
int64_t ResidualModels::code(Port& port, size_t channel, bool is_first, const Estimates& estimates,
                             int64_t last_residual, int64_t residual) {
  const int scale_class = std::clamp((estimates.scale[0] + 48) / 8, 0, int{kScaleClasses} - 1);
  Place place{&estimates, channel, is_first, static_cast<size_t>(scale_class),
              hold_class(estimates.offset[1])};
  std::array<uint64_t, kEstimates> above{}, below{}, zero{}, other{};
  for (size_t i = 0; i < kEstimates; ++i) {
    above[i] = share(estimates, i, 1, 1);
    below[i] = share(estimates, i, -1, 1);
    other[i] = above[i] + below[i];
    zero[i] = (uint64_t{1} << 31) - std::min<uint64_t>(other[i], uint64_t{1} << 31);
  }
  if (code_bit(port, place, kZeroNode, 0, zero, other, residual == 0)) return 0;
  const int sign_node = last_residual == 0 ? 1 : last_residual < 0 ? 2 : 3;
  const bool is_negative = code_bit(port, place, kSignNode, sign_node, below, above, residual < 0);
  place.hold_class = hold_class(is_negative ? -estimates.offset[1] : estimates.offset[1]);
  const int64_t magnitude =
      code_magnitude(port, place, is_negative ? -1 : 1, residual < 0 ? -residual : residual);
  return is_negative ? -magnitude : magnitude;
}

template int64_t ResidualModels::code(BinaryEncoder&, size_t, bool, const Estimates&, int64_t,
                                      int64_t);
template int64_t ResidualModels::code(BinaryListener&, size_t, bool, const Estimates&, int64_t,
                                      int64_t);
template int64_t ResidualModels::code(BinaryDecoder&, size_t, bool, const Estimates&, int64_t,
                                      int64_t);

}  // namespace engram::encoders
