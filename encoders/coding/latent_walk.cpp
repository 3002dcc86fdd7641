// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/latent_walk.h"

#include <algorithm>
#include <cstdlib>

namespace engram::encoders {

namespace {

constexpr int kMixerRate = 14;
/// How many bits a stored start is worth.
constexpr int kTrust = 30;
/// Starts: log odds in 1/16; this says that a context was never met.
constexpr int8_t kUnmet = -128;
constexpr int kLeastSeen = 2;

constexpr size_t kSteps = 6;  // Classes of how much there is of something.
constexpr size_t kFewSteps = 4;
constexpr size_t kWide = 7;    // Values -3 to 3 and beyond.
constexpr size_t kNarrow = 5;  // Values -2 to 2 and beyond.
constexpr int kRelations = 9;
constexpr size_t kPairs = kWide * kWide + 1;
constexpr size_t kRelationSlots = static_cast<size_t>(kRelations) * 3;

size_t wide(int32_t value) {
  return static_cast<size_t>(std::clamp(value, -3, 3) + 3);
}

size_t narrow(int32_t value) {
  return static_cast<size_t>(std::clamp(value, -2, 2) + 2);
}

/// 0, 1, 2, 3-4, 5-8, more.
size_t step(int64_t sum) {
  return sum <= 2 ? static_cast<size_t>(sum) : sum <= 4 ? 3 : sum <= 8 ? 4 : 5;
}

/// 0, 1-2, 3-6, more.
size_t few(int64_t sum) {
  return sum == 0 ? 0 : sum <= 2 ? 1 : sum <= 6 ? 2 : 3;
}

int64_t size(int64_t value) {
  return std::abs(value);
}

int64_t distance(int32_t a, int32_t b) {
  return size(int64_t{a} - b);
}

/// One channel of a row; zero outside.
class Plane {
 public:
  Plane(std::span<const int32_t> row, size_t first, const LatentGrid& shape, int channel)
      : values_(row.empty() ? nullptr
                            : row.data() + first +
                                  static_cast<size_t>(channel) *
                                      static_cast<size_t>(shape.height * shape.width)),
        height_(shape.height),
        width_(shape.width) {}

  [[nodiscard]] int32_t at(int y, int x) const {
    if (values_ == nullptr || y < 0 || x < 0 || y >= height_ || x >= width_) return 0;
    return values_[y * width_ + x];
  }

 private:
  const int32_t* values_;
  int height_;
  int width_;
};

AdaptiveBit bit_of(int8_t start) {
  return start == kUnmet ? AdaptiveBit() : AdaptiveBit(squash(LogOdds{start} * 16), kTrust);
}

}  // namespace

std::vector<LatentWalk::Grid> LatentWalk::lay_out(const std::vector<LatentGrid>& grids,
                                                  size_t& contexts) {
  std::vector<Grid> laid;
  size_t first = 0;
  contexts = 0;
  for (const LatentGrid& shape : grids) {
    const auto channels = static_cast<size_t>(shape.channels);
    const auto places = static_cast<size_t>(shape.height) * static_cast<size_t>(shape.width);
    Grid grid{shape, first, contexts, {}, std::vector<uint8_t>(places)};
    const std::array<size_t, kLatentContexts> sizes{channels * (kWide * kNarrow + 1),
                                                    kRowKinds * kWide * kSteps * kFewSteps,
                                                    kNarrow * kNarrow * kWide,
                                                    kRowKinds * kSteps * kSteps * kFewSteps,
                                                    places * 3,
                                                    channels * kSteps * 4,
                                                    kPairs + kRelationSlots};
    for (size_t i = 0; i < kLatentContexts; ++i) {
      grid.offset[i] = contexts;
      contexts += sizes[i];
    }
    first += shape.count();
    laid.push_back(std::move(grid));
  }
  return laid;
}

size_t LatentWalk::start_count(const std::vector<LatentGrid>& grids) {
  size_t contexts = 0;
  lay_out(grids, contexts);
  return contexts * kLatentNodes;
}

size_t LatentWalk::weight_count(const std::vector<LatentGrid>& grids) {
  return grids.size() * kRowKinds * kLatentNodes * (kLatentContexts + 1);
}

LatentWalk::LatentWalk(const LatentModel& model) {
  size_t contexts = 0;
  grids_ = lay_out(model.grids(), contexts);
  bits_.reserve(model.starts_.size());
  for (const int8_t start : model.starts_) bits_.push_back(bit_of(start));
  for (size_t i = 0; i < model.weights_.size(); i += kLatentContexts + 1) {
    LatentMixer::Weights weights{};
    std::copy_n(model.weights_.begin() + static_cast<ptrdiff_t>(i), weights.size(),
                weights.begin());
    mixers_.emplace_back(weights);
  }
  large_.resize(grids_.size());
}

void LatentWalk::store(LatentModel& model) const {
  for (size_t i = 0; i < bits_.size(); ++i)
    model.starts_[i] =
        bits_[i].seen() < kLeastSeen
            ? kUnmet
            : static_cast<int8_t>(std::clamp(log_odds(bits_[i].one()) / 16, -127, 127));
  auto weight = model.weights_.begin();
  for (const LatentMixer& mixer : mixers_) weight = std::ranges::copy(mixer.weights(), weight).out;
}

void LatentWalk::begin_block() {
  rows_ = 0;
  last_.clear();
  before_.clear();
}

/// How much the latents of a coarser grid differ from the last row's, for each place of `grid`.
void LatentWalk::note_changes(Grid& grid, const Grid& coarser, std::span<const int32_t> row) const {
  const LatentGrid& from = coarser.shape;
  for (int y = 0; y < grid.shape.height; ++y) {
    for (int x = 0; x < grid.shape.width; ++x) {
      const int fy = y * from.height / grid.shape.height, fx = x * from.width / grid.shape.width;
      int64_t sum = 0;
      for (int c = 0; c < from.channels; ++c)
        sum += distance(Plane(row, coarser.first, from, c).at(fy, fx),
                        Plane(last_, coarser.first, from, c).at(fy, fx));
      grid.change[static_cast<size_t>(y * grid.shape.width + x)] = static_cast<uint8_t>(few(sum));
    }
  }
}

LatentWalk::Place LatentWalk::place_of(const Grid& grid, size_t number,
                                       std::span<const int32_t> row, int c, int y, int x) const {
  const Plane now(row, grid.first, grid.shape, c);
  const Plane then(last_, grid.first, grid.shape, c);
  const bool is_first = rows_ == 0;
  const int32_t last = then.at(y, x);
  const int32_t before = rows_ < 2 ? last : Plane(before_, grid.first, grid.shape, c).at(y, x);
  const int32_t west = now.at(y, x - 1), north = now.at(y - 1, x);
  const int32_t west_north = now.at(y - 1, x - 1), east_north = now.at(y - 1, x + 1);
  const int64_t around = 2 * (size(west) + size(north)) + size(west_north) + size(east_north);
  const int64_t around_then = 2 * size(last) + size(then.at(y, x + 1)) + size(then.at(y + 1, x)) +
                              size(then.at(y - 1, x)) + size(then.at(y, x - 1));
  int64_t change = distance(west, then.at(y, x - 1)) + distance(north, then.at(y - 1, x)) +
                   distance(east_north, then.at(y - 1, x + 1));
  int64_t channels = 0;
  for (int before_c = std::max(0, c - 4); before_c < c; ++before_c) {
    const int32_t value = Plane(row, grid.first, grid.shape, before_c).at(y, x);
    channels += size(value);
    change += distance(value, Plane(last_, grid.first, grid.shape, before_c).at(y, x));
  }
  const auto channel = static_cast<size_t>(c);
  const auto place = static_cast<size_t>(y * grid.shape.width + x);
  const size_t kind = is_first ? 0 : 1;
  const size_t parent = grid.change[place];
  Place result;
  result.grid = number;
  result.row_kind = kind;
  result.last = last;
  const size_t past = is_first ? kWide * kNarrow : wide(last) * kNarrow + narrow(before);
  const std::array<size_t, kLatentContexts> index{
      channel * (kWide * kNarrow + 1) + past,
      ((kind * kWide + wide(last)) * kSteps + step(change)) * kFewSteps + parent,
      (narrow(west) * kNarrow + narrow(north)) * kWide + wide(last),
      ((kind * kSteps + step(around)) * kSteps + step(around_then)) * kFewSteps + few(channels),
      place * 3 + (is_first    ? 0
                   : last == 0 ? 1
                               : 2),
      (channel * kSteps + step(change)) * 4 +
          (is_first ? 3 : static_cast<size_t>(std::min<int64_t>(size(last), 2))),
      is_first ? kPairs - 1 : wide(last) * kWide + wide(before)};
  for (size_t i = 0; i < kLatentContexts; ++i)
    result.context[i] = (grid.offset[i] + index[i]) * kLatentNodes;
  result.relation = grid.offset[kLatentContexts - 1] + kPairs;
  return result;
}

template <typename Port>
bool LatentWalk::code_bit(Port& port, const Place& place, size_t node, size_t relation, bool bit) {
  std::array<AdaptiveBit*, kLatentContexts> bits{};
  std::array<LogOdds, kLatentContexts + 1> odds{};
  for (size_t i = 0; i < kLatentContexts; ++i) {
    const bool is_relation = i + 1 == kLatentContexts && node >= 2;
    bits[i] = &bits_[(is_relation ? relation * kLatentNodes : place.context[i]) + node];
    odds[i] = log_odds(bits[i]->one());
  }
  odds[kLatentContexts] = 256;
  LatentMixer& mixer = mixers_[(place.grid * kRowKinds + place.row_kind) * kLatentNodes + node];
  const BitProbability one = std::clamp<BitProbability>(mixer.mix(odds), 24, 65536 - 24);
  bit = port.code(bit, one);
  mixer.update(odds, one, bit, kMixerRate);
  for (AdaptiveBit* each : bits) each->update(bit);
  return bit;
}

template <typename Port>
int32_t LatentWalk::code_latent(Port& port, const Place& place, int32_t value) {
  if (code_bit(port, place, 0, 0, value == 0)) return 0;
  const bool is_negative = code_bit(port, place, 1, 0, value < 0);
  const bool is_first = place.row_kind == 0;
  const size_t side = is_first || place.last == 0 ? 0 : (place.last < 0) == is_negative ? 1 : 2;
  const int64_t needed = size(value);
  int64_t magnitude = 1;
  for (; magnitude <= static_cast<int64_t>(kLatentUnary); ++magnitude) {
    const int64_t beyond = std::clamp<int64_t>(magnitude - size(place.last), -4, 4) + 4;
    const size_t relation =
        place.relation + side * static_cast<size_t>(kRelations) + static_cast<size_t>(beyond);
    if (!code_bit(port, place, static_cast<size_t>(magnitude) + 1, relation, needed > magnitude))
      break;
  }
  // Hostile bytes may tell of anything.
  if (magnitude > static_cast<int64_t>(kLatentUnary))
    magnitude +=
        std::clamp<int64_t>(large_[place.grid].code(port, needed - magnitude), 0, int64_t{1} << 31);
  const int64_t result = is_negative ? -magnitude : magnitude;
  return static_cast<int32_t>(std::clamp<int64_t>(result, INT32_MIN, INT32_MAX));
}

template <typename Port>
void LatentWalk::code_row(Port& port, std::span<int32_t> row) {
  if (Port::kIsDecoder) std::ranges::fill(row, 0);
  for (size_t number = 0; number < grids_.size(); ++number) {
    Grid& grid = grids_[number];
    if (number > 0) note_changes(grid, grids_[number - 1], row);
    int32_t* value = row.data() + grid.first;
    for (int c = 0; c < grid.shape.channels; ++c)
      for (int y = 0; y < grid.shape.height; ++y)
        for (int x = 0; x < grid.shape.width; ++x, ++value)
          *value = code_latent(port, place_of(grid, number, row, c, y, x), *value);
  }
  before_ = std::move(last_);
  last_.assign(row.begin(), row.end());
  ++rows_;
}

template void LatentWalk::code_row(BinaryEncoder&, std::span<int32_t>);
template void LatentWalk::code_row(BinaryDecoder&, std::span<int32_t>);
template void LatentWalk::code_row(BinaryListener&, std::span<int32_t>);
template void LatentWalk::code_row(BitCounter&, std::span<int32_t>);

}  // namespace engram::encoders
