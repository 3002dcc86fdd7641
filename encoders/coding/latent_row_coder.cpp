// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/latent_row_coder.h"

#include <algorithm>
#include <cstdlib>

namespace engram::encoders {

namespace {

constexpr int kRowMixerRate = 14;
/// Number of bits that a stored start counts as.
constexpr int kTrust = 30;
/// Marks a context that training never met. Other starts are log odds in 1/16.
constexpr int8_t kUnmet = -128;
constexpr int kMinSeen = 2;

constexpr size_t kChanges = LatentNeighbourhood::kSteps;
constexpr size_t kFewSteps = LatentNeighbourhood::kFewSteps;
constexpr size_t kWide = LatentNeighbourhood::kWide;
constexpr size_t kNarrow = LatentNeighbourhood::kNarrow;
constexpr size_t kRelations = 9;
constexpr size_t kPairs = kWide * kWide + 1;

int64_t size(int64_t value) {
  return std::abs(value);
}

AdaptiveBit bit_of(int8_t start) {
  return start == kUnmet ? AdaptiveBit() : AdaptiveBit(squash(LogOdds{start} * 16), kTrust);
}

/// The adaptive bits of all possible starts, from INT8_MIN on.
const std::array<OddsBit, 256>& all_bits() {
  static const auto bits = [] {
    std::array<OddsBit, 256> made;
    for (int start = INT8_MIN; start <= INT8_MAX; ++start)
      made[static_cast<size_t>(start - INT8_MIN)] = OddsBit(bit_of(static_cast<int8_t>(start)));
    return made;
  }();
  return bits;
}

}  // namespace

std::vector<LatentRowCoder::Contexts> LatentRowCoder::lay_out(
    const std::vector<LatentGrid>& grids) {
  std::vector<Contexts> laid;
  size_t next = 0;
  for (const LatentGrid& shape : grids) {
    const auto channels = static_cast<size_t>(shape.channels);
    const auto places = static_cast<size_t>(shape.height) * static_cast<size_t>(shape.width);
    const std::array<size_t, kLatentContexts> sizes{channels * (kWide * kNarrow + 1),
                                                    kRowKinds * kWide * kChanges * kFewSteps,
                                                    kNarrow * kNarrow * kWide,
                                                    kRowKinds * kChanges * kChanges * kFewSteps,
                                                    places * 3,
                                                    channels * kChanges * 4,
                                                    kPairs + kRelations * 3};
    Contexts& contexts = laid.emplace_back();
    for (size_t i = 0; i < kLatentContexts; ++i) {
      contexts.offset[i] = next;
      next += sizes[i];
    }
    contexts.end = next;
  }
  return laid;
}

size_t LatentRowCoder::start_count(const std::vector<LatentGrid>& grids) {
  return lay_out(grids).back().end * kLatentNodes;
}

size_t LatentRowCoder::weight_count(const std::vector<LatentGrid>& grids) {
  return grids.size() * kRowKinds * kLatentNodes * (kLatentContexts + 1);
}

LatentRowCoder::LatentRowCoder(const LatentModel& model)
    : model_(model), odds_(odds_table()), last_(model.latents()) {
  for (size_t i = 0; i < model.weights_.size(); i += kLatentContexts + 1) {
    LatentMixer::Weights weights{};
    std::copy_n(model.weights_.begin() + static_cast<ptrdiff_t>(i), weights.size(),
                weights.begin());
    mixers_.emplace_back(weights);
  }
  const std::vector<Contexts> contexts = lay_out(model.grids());
  for (size_t i = 0; i < contexts.size(); ++i) {
    const LatentGrid& shape = model.grids()[i];
    const auto places = static_cast<size_t>(shape.height) * static_cast<size_t>(shape.width);
    grids_.push_back({shape, contexts[i], LatentNeighbourhood(shape), std::vector<uint8_t>(places),
                      IntegerModel()});
  }
}

std::vector<OddsBit>& LatentRowCoder::bits_of(size_t node) {
  std::vector<OddsBit>& bits = bits_[node];
  if (!bits.empty()) return bits;
  const auto& all = all_bits();
  bits.reserve(model_.starts_.size() / kLatentNodes);
  for (size_t i = node; i < model_.starts_.size(); i += kLatentNodes)
    bits.push_back(all[static_cast<size_t>(model_.starts_[i] - INT8_MIN)]);
  return bits;
}

void LatentRowCoder::store(LatentModel& model) {
  for (size_t node = 0; node < kLatentNodes; ++node) {
    size_t at = node;
    for (const OddsBit& each : bits_of(node)) {
      const bool is_unmet = each.bit().seen() < kMinSeen;
      model.starts_[at] =
          is_unmet ? kUnmet : static_cast<int8_t>(std::clamp(each.odds() / 16, -127, 127));
      at += kLatentNodes;
    }
  }
  auto weight = model.weights_.begin();
  for (const LatentMixer& mixer : mixers_) weight = std::ranges::copy(mixer.weights(), weight).out;
}

void LatentRowCoder::begin_block() {
  rows_ = 0;
  std::ranges::fill(last_, 0);
  for (Grid& grid : grids_) grid.around.begin_block();
}

LatentRowCoder::Place LatentRowCoder::place_of(const Grid& grid, size_t at, size_t channel,
                                               size_t place) const {
  const LatentNeighbourhood::Classes is = grid.around.classes(at);
  const bool is_first = rows_ == 0;
  const size_t kind = is_first ? 0 : 1;
  const size_t past = is_first ? kWide * kNarrow : is.last * kNarrow + is.past;
  const size_t moment = is_first ? 0 : 1 + std::min<size_t>(is.last_size, 1);
  const std::array<size_t, kLatentContexts> index{
      channel * (kWide * kNarrow + 1) + past,
      ((kind * kWide + is.last) * kChanges + is.change) * kFewSteps + grid.change[place],
      (is.west * kNarrow + is.north) * kWide + is.last,
      ((kind * kChanges + is.around) * kChanges + is.around_then) * kFewSteps + is.channels,
      place * 3 + moment,
      (channel * kChanges + is.change) * 4 + (is_first ? 3 : is.last_size),
      is_first ? kPairs - 1 : is.last * kWide + is.before};
  Place result;
  for (size_t i = 0; i < kLatentContexts; ++i) result[i] = grid.contexts.offset[i] + index[i];
  return result;
}

template <typename Port>
bool LatentRowCoder::code_bit(Port& port, const Place& place, LatentMixer& mixer,
                              std::vector<OddsBit>& bits, bool bit) {
  std::array<OddsBit*, kLatentContexts> estimates{};
  std::array<LogOdds, kLatentContexts + 1> odds{};
  for (size_t i = 0; i < kLatentContexts; ++i) {
    estimates[i] = &bits[place[i]];
    odds[i] = estimates[i]->odds();
  }
  odds[kLatentContexts] = 256;
  const BitProbability one = std::clamp<BitProbability>(mixer.mix(odds), 24, 65536 - 24);
  bit = port.code(bit, one);
  mixer.update(odds, one, bit, kRowMixerRate);
  for (OddsBit* estimate : estimates) estimate->update(bit, odds_);
  return bit;
}

template <typename Port>
int32_t LatentRowCoder::code_other(Port& port, Grid& grid, Place place, LatentMixer* mixers,
                                   int32_t last, int32_t value) {
  const bool is_negative = code_bit(port, place, mixers[1], bits_of(1), value < 0);
  const size_t side = rows_ == 0 || last == 0 ? 0 : (last < 0) == is_negative ? 1 : 2;
  const size_t relation = grid.contexts.offset.back() + kPairs + side * kRelations;
  const int64_t needed = size(value);
  int64_t magnitude = 1;
  for (; magnitude <= static_cast<int64_t>(kLatentUnary); ++magnitude) {
    const int64_t beyond = std::clamp<int64_t>(magnitude - size(last), -4, 4) + 4;
    const auto node = static_cast<size_t>(magnitude) + 1;
    place.back() = relation + static_cast<size_t>(beyond);
    if (!code_bit(port, place, mixers[node], bits_of(node), needed > magnitude)) break;
  }
  // Hostile bytes may decode to any magnitude.
  if (magnitude > static_cast<int64_t>(kLatentUnary))
    magnitude +=
        std::clamp<int64_t>(grid.large.code(port, needed - magnitude), 0, int64_t{1} << 31);
  const int64_t result = is_negative ? -magnitude : magnitude;
  return static_cast<int32_t>(std::clamp<int64_t>(result, INT32_MIN, INT32_MAX));
}

template <typename Port>
void LatentRowCoder::code_row(Port& port, std::span<int32_t> row) {
  std::vector<OddsBit>& zero_bits = bits_of(0);
  size_t i = 0;
  for (size_t number = 0; number < grids_.size(); ++number) {
    Grid& grid = grids_[number];
    if (number > 0) grids_[number - 1].around.find_changes(grid.shape, grid.change);
    const size_t kind = rows_ == 0 ? 0 : 1;
    LatentMixer* mixers = &mixers_[(number * kRowKinds + kind) * kLatentNodes];
    for (int c = 0; c < grid.shape.channels; ++c) {
      grid.around.begin_channel(c);
      for (size_t place = 0; place < grid.change.size(); ++place, ++i) {
        const size_t at = grid.around.place(place);
        const Place contexts = place_of(grid, at, static_cast<size_t>(c), place);
        row[i] = code_bit(port, contexts, mixers[0], zero_bits, row[i] == 0)
                     ? 0
                     : code_other(port, grid, contexts, mixers, last_[i], row[i]);
        grid.around.put(at, row[i], last_[i]);
      }
    }
    grid.around.end_row();
  }
  std::ranges::copy(row, last_.begin());
  ++rows_;
}

template void LatentRowCoder::code_row(BinaryEncoder&, std::span<int32_t>);
template void LatentRowCoder::code_row(BinaryDecoder&, std::span<int32_t>);
template void LatentRowCoder::code_row(BinaryListener&, std::span<int32_t>);
template void LatentRowCoder::code_row(BitCounter&, std::span<int32_t>);

}  // namespace engram::encoders
