// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_row_coder.h"

#include <cmath>

#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

constexpr int kTermBits = 12;
/// Max residual: the distance from the largest prediction to the smallest value. ResidualModels
/// reads no larger one.
constexpr int64_t kMaxResidual = (int64_t{1} << 41) - 1;
constexpr int64_t kMaxSize = int64_t{1} << 24;
constexpr int64_t kMaxFeature = int64_t{1} << 36;
constexpr int64_t kMaxWeight = int64_t{1} << 19;
constexpr int64_t kMaxOffset = int64_t{1} << 30;
/// Learning rate of the adapting predictor: 2^-kAdaptRate.
constexpr int kAdaptRate = 7;

int64_t clamp_units(int64_t units) {
  return std::clamp(units, -kMaxUnits, kMaxUnits);
}

int64_t nearest_step(double distance, double step) {
  const double steps = std::nearbyint(distance / step);
  return static_cast<int64_t>(
      std::clamp(steps, -static_cast<double>(kMaxResidual), static_cast<double>(kMaxResidual)));
}

}  // namespace

NumberRowCoder::NumberRowCoder(const NumberModel& model)
    : model_(model),
      models_(model),
      history_(model.channels.size()),
      last_row_(model.count()),
      is_plain_(model.count(), AdaptiveBit(1 << 13, 8)) {
  for (const NumberField& field : model.fields) add_field(field);
  for (size_t i = 0; i < history_.size(); ++i) {
    const NumberChannel& channel = model.channels[i];
    const int32_t size = std::clamp<int32_t>(channel.usual_scale, 0, 64);
    history_[i].fast = history_[i].slow = ((int64_t{1} << 40) / inverse_power(4 * size)) >> 20;
    history_[i].last = clamp_units(channel.start * steps_[i]);
    history_[i].before = history_[i].earlier = history_[i].now = history_[i].last;
    auto& weights = adapted_.emplace_back();
    for (const PredictorTerm& term : channel.terms) weights.push_back(int32_t{term.weight} * 16);
  }
}

void NumberRowCoder::add_field(const NumberField& field) {
  if (field.kind != NumberKind::kOrientation) {
    steps_.insert(steps_.end(), field.count, step_units(field));
    return;
  }
  RotationParameters start{};
  for (size_t i = 0; i < 3; ++i)
    start[i] =
        static_cast<double>(model_.channels[steps_.size() + i].start) * parameter_step(field.bound);
  const Quaternion first = canonical(from_parameters(start));
  orientations_.push_back({first, first});
  was_negative_.push_back(false);
  sign_changes_.emplace_back(1 << 11, 8);
  steps_.insert(steps_.end(), 3, 1);
}

int64_t NumberRowCoder::feature(const PredictorTerm& term, size_t channel) const {
  const ChannelHistory& from = history_[term.channel];
  switch (term.kind) {
    case FeatureKind::kChange:
      return from.last - from.before;
    case FeatureKind::kChangeBefore:
      return from.before - from.earlier;
    case FeatureKind::kChangeNow:
      return from.now - from.last;
    case FeatureKind::kLevelNow:
      return from.now - history_[channel].last;
    case FeatureKind::kLevel:
      return from.last - history_[channel].last;
  }
  return 0;
}

std::array<int32_t, kScaleInputs> NumberRowCoder::sizes(size_t channel,
                                                        const Estimates& estimates) const {
  const auto log_of = [](int64_t size) {
    return log2_sixteenths(static_cast<uint64_t>(size) + 2) - 64;
  };
  const ChannelHistory& own = history_[channel];
  const int64_t recent = (recent_[0] + recent_[1] + recent_[2] + recent_[3]) / 4;
  const int64_t row = channel == 0 ? row_before_ : row_sum_ / static_cast<int64_t>(channel);
  const int64_t moved = (std::abs(estimates.offset[1]) + std::abs(estimates.offset[2])) / 2;
  return {log_of(own.fast), log_of(own.slow),    log_of(recent),
          log_of(row),      log_of(row_before_), log_of(moved)};
}

int64_t NumberRowCoder::adapted_change(size_t channel) const {
  int64_t sum = 0;
  const auto& terms = model_.channels[channel].terms;
  for (size_t i = 0; i < terms.size(); ++i)
    sum += std::clamp(feature(terms[i], channel), -kMaxFeature, kMaxFeature) * adapted_[channel][i];
  return sum >> 16;
}

NumberRowCoder::Prediction NumberRowCoder::predict(size_t channel) const {
  const NumberChannel& known = model_.channels[channel];
  const ChannelHistory& own = history_[channel];
  Prediction result;
  result.centre = own.last;
  if (rows_ == 0) {
    result.estimates.scale.fill(std::clamp(4 * known.start_scale, -64, 320));
    return result;
  }
  int64_t change = 0;
  for (const PredictorTerm& term : known.terms) change += feature(term, channel) * term.weight;
  change >>= kTermBits;
  result.centre = clamp_units(own.last + change);
  const auto offset_of = [&](int64_t other) {
    return std::clamp((other - change) * 16 / steps_[channel], -kMaxOffset, kMaxOffset);
  };
  result.estimates.offset = {0, offset_of(0), offset_of((own.last - own.before) * 3 / 4),
                             offset_of(adapted_change(channel))};
  result.sizes = sizes(channel, result.estimates);
  int32_t scale = 0;
  for (size_t i = 0; i < kScaleInputs; ++i) scale += result.sizes[i] * model_.scale_weights[i];
  for (size_t i = 0; i < kEstimates; ++i)
    result.estimates.scale[i] = std::clamp(scale / 256 + known.scale_bias[i], -64, 320);
  return result;
}

// Normalised least mean squares. Sizes are clamped, so that products stay within 64 bits.
void NumberRowCoder::adapt(size_t channel) {
  const auto& terms = model_.channels[channel].terms;
  const ChannelHistory& own = history_[channel];
  std::array<int64_t, NumberChannel::kMaxTerms> sizes{};
  int64_t power = 512;
  for (size_t i = 0; i < terms.size(); ++i) {
    sizes[i] = std::clamp(feature(terms[i], channel) * 16 / steps_[channel], -kMaxSize, kMaxSize);
    power += sizes[i] * sizes[i];
  }
  const int64_t error = std::clamp(
      (own.now - own.last - adapted_change(channel)) * 16 / steps_[channel], -kMaxSize, kMaxSize);
  for (size_t i = 0; i < terms.size(); ++i) {
    const int64_t change = (error * sizes[i] / (power >> 8 | 1)) << (8 - kAdaptRate);
    adapted_[channel][i] = static_cast<int32_t>(
        std::clamp<int64_t>(adapted_[channel][i] + change, -kMaxWeight, kMaxWeight));
  }
}

void NumberRowCoder::learn(size_t channel, int64_t residual) {
  ChannelHistory& own = history_[channel];
  const int64_t size = std::min((residual < 0 ? -residual : residual) * 16, kMaxSize);
  own.residual = residual;
  if (rows_ > 0) {
    own.fast = (own.fast + size + 1) / 2;
    own.slow = (7 * own.slow + size + 4) / 8;
    adapt(channel);
  }
  row_sum_ += size;
  recent_[channel % recent_.size()] = size;
}

template <typename Port>
int64_t NumberRowCoder::code_residual(Port& port, size_t channel, const Prediction& prediction,
                                      int64_t residual) {
  const int64_t coded = models_.code(port, channel, rows_ == 0, prediction.estimates,
                                     history_[channel].residual, residual);
  if (trace_ != nullptr)
    trace_->push_back({channel, rows_ == 0, prediction.sizes, prediction.estimates.offset, coded});
  return coded;
}

template <typename Port>
void NumberRowCoder::code_number(Port& port, const NumberField& field, size_t channel,
                                 double& value) {
  const NumberChannel& known = model_.channels[channel];
  const Prediction prediction = predict(channel);
  const int64_t step = steps_[channel];
  int64_t residual = 0;
  if constexpr (!Port::kIsDecoder)
    residual = nearest_step(to_units(field, known, value) - static_cast<double>(prediction.centre),
                            static_cast<double>(step));
  residual = code_residual(port, channel, prediction, residual);
  history_[channel].now = clamp_units(prediction.centre + residual * step);
  const double coded = from_units(field, known, history_[channel].now);
  if constexpr (!Port::kIsDecoder)
    ENGRAM_CHECK(
        is_exact(field.kind) ? has_same_bits(coded, value) : std::abs(coded - value) <= field.bound,
        "{} became {}, bound {}", value, coded, field.bound);
  value = coded;
  learn(channel, residual);
}

template <typename Port>
void NumberRowCoder::code_orientation(Port& port, size_t orientation, double bound_rad,
                                      size_t channel, std::span<double, 4> value) {
  const auto& [last, before] = orientations_[orientation];
  const int eighths = std::min<int>(model_.channels[channel].eighths, 8);
  const Quaternion expected = rows_ < 2 ? last : extrapolate(before, last, eighths);
  const double step = parameter_step(bound_rad);
  RotationParameters parameters{};
  if constexpr (!Port::kIsDecoder)
    parameters = to_parameters(
        multiply(Quaternion{value[0], value[1], value[2], value[3]}, conjugate(expected)));
  for (size_t i = 0; i < 3; ++i) {
    const Prediction prediction = predict(channel + i);
    int64_t residual = nearest_step(parameters[i], step);
    residual = code_residual(port, channel + i, prediction, residual);
    parameters[i] = static_cast<double>(residual) * step;
    learn(channel + i, residual);
  }
  const Quaternion coded = canonical(multiply(from_parameters(parameters), expected));
  bool is_changed = false;
  if constexpr (!Port::kIsDecoder) {
    const double angle =
        angle_between_rad(coded, canonical({value[0], value[1], value[2], value[3]}));
    ENGRAM_CHECK(angle <= bound_rad, "turned by {} rad, bound {}", angle, bound_rad);
    double dot = 0;
    for (size_t i = 0; i < 4; ++i) dot += coded[i] * value[i];
    is_changed = (dot < 0) != was_negative_[orientation];
  }
  is_changed = sign_changes_[orientation].code(port, is_changed);
  const bool is_negative = was_negative_[orientation] != is_changed;
  was_negative_[orientation] = is_negative;
  for (size_t i = 0; i < 4; ++i) value[i] = is_negative ? -coded[i] : coded[i];
  orientations_[orientation] = {coded, last};
}

bool NumberRowCoder::must_be_plain(const NumberField& field, size_t channel,
                                   std::span<const double> values) const {
  if (field.kind == NumberKind::kOrientation) return !is_unit(values.first<4>());
  const NumberChannel& known = model_.channels[channel];
  if (is_exact(field.kind)) return !has_decimals(field, known.decimals, values[0]);
  // The comparison is false for NaN, which is therefore plain.
  return !(std::abs(to_units(field, known, values[0])) < static_cast<double>(kMaxUnits / 2));
}

/// Makes a value that was stored bit by bit the basis of the next prediction, if it fits the
/// lattice.
void NumberRowCoder::take_plain(const NumberField& field, size_t channel, double value) {
  const double units = to_units(field, model_.channels[channel], value);
  ChannelHistory& own = history_[channel];
  own.now = own.last;
  if (std::abs(units) < static_cast<double>(kMaxUnits)) own.now = std::llround(units);
}

template <typename Port>
void NumberRowCoder::code_plain(Port& port, NumberKind kind, size_t number, double& value) {
  if (kind == NumberKind::kExactFloat) {
    const int64_t last = ordered_float(static_cast<float>(last_row_[number]));
    const int64_t now = ordered_float(static_cast<float>(value));
    const auto change = static_cast<uint64_t>(plain_.code(port, now - last));
    value = from_ordered_float(static_cast<int64_t>(static_cast<uint64_t>(last) + change));
    return;
  }
  const uint64_t from = ordered(last_row_[number]);
  const int64_t difference = static_cast<int64_t>(ordered(value) - from);
  value = from_ordered(from + static_cast<uint64_t>(plain_.code(port, difference)));
}

template <typename Port>
bool NumberRowCoder::code_is_plain(Port& port, bool row_has_plain, size_t number, bool is_plain) {
  return row_has_plain && is_plain_[number].code(port, is_plain);
}

bool NumberRowCoder::any_must_be_plain(std::span<const double> row) const {
  size_t number = 0, channel = 0;
  for (const NumberField& field : model_.fields) {
    const bool is_orientation = field.kind == NumberKind::kOrientation;
    for (size_t i = 0; i < (is_orientation ? 1 : field.count); ++i)
      if (must_be_plain(field, channel + i, row.subspan(number + i))) return true;
    number += field.count;
    channel += is_orientation ? 3 : field.count;
  }
  return false;
}

template <typename Port>
void NumberRowCoder::code_field(Port& port, const NumberField& field, bool has_plain, Cursor& at,
                                std::span<double> row) {
  const bool is_orientation = field.kind == NumberKind::kOrientation;
  const size_t channels = is_orientation ? 3 : 1;
  for (size_t i = 0; i < field.count; i += is_orientation ? 4 : 1) {
    const auto values = row.subspan(at.number, is_orientation ? 4 : 1);
    bool is_plain = false;
    if constexpr (!Port::kIsDecoder)
      is_plain = has_plain && must_be_plain(field, at.channel, values);
    is_plain = code_is_plain(port, has_plain, at.number, is_plain);
    if (is_plain) {
      for (size_t k = 0; k < values.size(); ++k)
        code_plain(port, field.kind, at.number + k, values[k]);
      if (!is_orientation) take_plain(field, at.channel, values[0]);
    } else if (is_orientation) {
      code_orientation(port, at.orientation, field.bound, at.channel, values.template first<4>());
    } else {
      code_number(port, field, at.channel, values[0]);
    }
    at.number += values.size();
    at.channel += channels;
    at.orientation += is_orientation ? 1 : 0;
  }
}

template <typename Port>
void NumberRowCoder::code(Port& port, std::span<double> row) {
  bool has_plain = false;
  if constexpr (!Port::kIsDecoder) has_plain = any_must_be_plain(row);
  has_plain = any_plain_.code(port, has_plain);
  row_sum_ = 0;
  recent_.fill(row_before_);
  Cursor at;
  for (const NumberField& field : model_.fields) code_field(port, field, has_plain, at, row);
  end_row(row);
}

void NumberRowCoder::end_row(std::span<const double> row) {
  for (ChannelHistory& channel : history_) {
    channel.earlier = rows_ == 0 ? channel.now : channel.before;
    channel.before = rows_ == 0 ? channel.now : channel.last;
    channel.last = channel.now;
  }
  if (rows_ == 0)
    for (auto& [last, before] : orientations_) before = last;
  if (rows_ > 0)
    row_before_ = row_sum_ / static_cast<int64_t>(std::max<size_t>(history_.size(), 1));
  std::ranges::copy(row, last_row_.begin());
  ++rows_;
}

template void NumberRowCoder::code(BinaryEncoder&, std::span<double>);
template void NumberRowCoder::code(BinaryListener&, std::span<double>);
template void NumberRowCoder::code(BinaryDecoder&, std::span<double>);

}  // namespace engram::encoders
