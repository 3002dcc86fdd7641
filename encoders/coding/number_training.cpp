// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_training.h"

#include <algorithm>
#include <cmath>

#include "encoders/coding/number_fit.h"

namespace engram::encoders {

namespace {

constexpr int kClosedLoops = 2;
constexpr int kPasses = 3;
constexpr uint8_t kMaxDecimals = 12;

using Rows = std::vector<double>;

/// Calls visit(field, channel, number) for every number but those of orientations, then
/// visit_orientation(field, channel, number) for those.
template <typename Visit, typename VisitOrientation>
void for_each_number(const NumberModel& model, Visit visit, VisitOrientation visit_orientation) {
  size_t channel = 0, number = 0;
  for (const NumberField& field : model.fields) {
    const bool is_orientation = field.kind == NumberKind::kOrientation;
    if (is_orientation) visit_orientation(field, channel, number);
    for (size_t i = 0; i < field.count && !is_orientation; ++i)
      visit(field, channel + i, number + i);
    channel += is_orientation ? 3 : field.count;
    number += field.count;
  }
}

/// Takes the same share of every recording from its start, but at least one row if it has any.
std::vector<Rows> sample(std::span<const Rows> recordings, size_t numbers, size_t max_rows) {
  size_t rows = 0;
  for (const Rows& recording : recordings) rows += recording.size() / numbers;
  std::vector<Rows> result;
  for (const Rows& recording : recordings) {
    const size_t own = recording.size() / numbers;
    const size_t kept =
        rows <= max_rows ? own : std::min(own, std::max<size_t>(own * max_rows / rows, 1));
    result.emplace_back(recording.begin(),
                        recording.begin() + static_cast<ptrdiff_t>(kept * numbers));
  }
  return result;
}

int8_t quarter_octaves(double size, int min, int max) {
  const long result = size > 0 ? std::lround(4 * std::log2(size)) : min;
  return static_cast<int8_t>(std::clamp<long>(result, min, max));
}

/// Number of bits by which float32 is finer than `step` at `value`.
double bits_of_floats(double value, double step) {
  const float size = std::abs(static_cast<float>(value));
  const double finest = std::nextafter(size, INFINITY) - double{size};
  return std::isfinite(finest) && finest > 0 ? std::log2(step / finest) : 0;
}

class Training {
 public:
  Training(NumberModel model, std::span<const Rows> recordings, const NumberTraining& options)
      : model_(std::move(model)),
        numbers_(model_.count()),
        options_(options),
        recordings_(sample(recordings, numbers_, options.max_rows)) {}

  NumberModel run() {
    fit_decimals();
    fit_orientations();
    fit_starts();
    // The first fit uses recorded values. The next ones use decoded values, since a decoder
    // predicts from those.
    for (int i = 0; i <= kClosedLoops; ++i) fit_predictors(i == 0);
    std::vector<ResidualTrace> trace;
    pass(&trace, nullptr);
    fit_usual_scales(trace);
    trace.clear();
    pass(&trace, nullptr);
    fit_scales(trace, model_);
    learn_starts();
    return model_;
  }

 private:
  /// Visits the rows at the starts of blocks, or all rows.
  template <typename Visit>
  void for_each_row(bool is_start, Visit visit) const {
    for (const Rows& rows : recordings_)
      for (size_t at = 0, row = 0; at < rows.size(); at += numbers_, ++row)
        if (!is_start || row == 0 || (options_.block_rows > 0 && row % options_.block_rows == 0))
          visit(std::span(rows).subspan(at, numbers_));
  }

  void fit_decimals() {
    const auto fit = [&](const NumberField& field, size_t channel, size_t number) {
      if (!is_exact(field.kind)) return;
      for (uint8_t decimals = 0; decimals <= kMaxDecimals; ++decimals) {
        size_t all = 0, fitting = 0;
        double saved_bits = 0;
        for_each_row(false, [&](std::span<const double> row) {
          ++all;
          if (!has_decimals(field, decimals, row[number])) return;
          ++fitting;
          saved_bits += bits_of_floats(row[number], std::pow(10.0, -decimals));
        });
        // Up to 2 % of the values may not fit: they are stored bit by bit.
        if (fitting * 100 < all * 98) continue;
        // Many decimals may be finer than float32 itself. Then ordered bits are the smaller
        // integers.
        if (field.kind == NumberKind::kExactFloat && saved_bits <= 0) break;
        model_.channels[channel].decimals = decimals;
        return;
      }
      if (field.kind == NumberKind::kExactFloat)
        model_.channels[channel].decimals = NumberChannel::kAsOrdered;
    };
    for_each_number(model_, fit, [](auto&, size_t, size_t) {});
  }

  /// Chooses the share of the last turn that continues, by the smallest remaining angles.
  void fit_orientations() {
    const auto fit = [&](const NumberField&, size_t channel, size_t number) {
      double min = INFINITY;
      for (const uint8_t eighths : {0, 4, 6, 8}) {
        const double sum = turn_left(number, eighths);
        if (sum >= min) continue;
        min = sum;
        model_.channels[channel].eighths = eighths;
      }
    };
    for_each_number(
        model_, [](auto&, size_t, size_t) {}, fit);
  }

  [[nodiscard]] double turn_left(size_t number, int eighths) const {
    double sum = 0;
    for (const Rows& rows : recordings_) {
      std::vector<Quaternion> before;
      for (size_t at = number; at < rows.size(); at += numbers_) {
        const Quaternion q{rows[at], rows[at + 1], rows[at + 2], rows[at + 3]};
        if (!is_unit(q)) continue;
        if (before.size() == 2)
          sum += angle_between_rad(extrapolate(before[0], before[1], eighths), canonical(q));
        if (before.size() == 2) before.erase(before.begin());
        before.push_back(canonical(q));
      }
    }
    return sum;
  }

  void fit_starts() {
    const auto fit = [&](const NumberField& field, size_t channel, size_t number) {
      std::vector<double> values;
      NumberChannel& known = model_.channels[channel];
      for_each_row(true, [&](std::span<const double> row) {
        const double units = to_units(field, known, row[number]);
        if (std::abs(units) < static_cast<double>(kMaxUnits))
          values.push_back(units / static_cast<double>(step_units(field)));
      });
      fit_start(std::move(values), known);
    };
    const auto fit_turn = [&](const NumberField& field, size_t channel, size_t number) {
      std::array<std::vector<double>, 3> values;
      for_each_row(true, [&](std::span<const double> row) {
        const auto q = row.subspan(number).first<4>();
        if (!is_unit(q)) return;
        const auto parameters = to_parameters({q[0], q[1], q[2], q[3]});
        for (size_t i = 0; i < 3; ++i)
          values[i].push_back(parameters[i] / parameter_step(field.bound));
      });
      for (size_t i = 0; i < 3; ++i) fit_start(std::move(values[i]), model_.channels[channel + i]);
    };
    for_each_number(model_, fit, fit_turn);
  }

  static void fit_start(std::vector<double> values, NumberChannel& channel) {
    if (values.empty()) return;
    std::ranges::sort(values);
    const double middle = std::nearbyint(values[values.size() / 2]);
    double spread = 0;
    for (const double value : values) spread += std::abs(value - middle);
    spread /= static_cast<double>(values.size());
    channel.start = static_cast<int64_t>(middle);
    channel.start_scale = quarter_octaves(spread / 1.4 + 0.2, -8, 80);
  }

  void fit_predictors(bool is_open) {
    const std::vector<ChannelRows> channels = channel_rows(is_open);
    for (size_t i = 0; i < model_.channels.size(); ++i)
      model_.channels[i].terms = fit_terms(model_, i, channels, options_);
  }

  /// The rows from which predictors are fitted: values as the current model codes them, or recorded
  /// values if `is_open`.
  [[nodiscard]] std::vector<ChannelRows> channel_rows(bool is_open) const {
    std::vector<ChannelRows> result;
    for (const Rows& rows : recordings_) {
      ChannelRows channels;
      NumberRowCoder coder(model_);
      BinaryListener listener;
      for (size_t at = 0; at < rows.size(); at += numbers_) {
        std::vector<double> row(rows.begin() + static_cast<ptrdiff_t>(at),
                                rows.begin() + static_cast<ptrdiff_t>(at + numbers_));
        const std::vector<double> real = row;
        coder.code(listener, row);
        add_row(coder, real, is_open, channels);
      }
      result.push_back(std::move(channels));
    }
    return result;
  }

  void add_row(const NumberRowCoder& coder, std::span<const double> row, bool is_open,
               ChannelRows& channels) const {
    std::vector<double> coded(model_.channels.size()), real(model_.channels.size());
    const auto add = [&](const NumberField& field, size_t channel, size_t number) {
      const auto step = static_cast<double>(step_units(field));
      const double units = to_units(field, model_.channels[channel], row[number]);
      coded[channel] = static_cast<double>(coder.history()[channel].last) / step;
      real[channel] =
          std::abs(units) < static_cast<double>(kMaxUnits) ? units / step : coded[channel];
      if (is_open) coded[channel] = real[channel];
    };
    for_each_number(model_, add, [](auto&, size_t, size_t) {});
    channels.coded.push_back(std::move(coded));
    channels.real.push_back(std::move(real));
  }

  /// Codes everything block by block. `models` continue to learn from block to block; if it is
  /// null, each block starts from the model.
  void pass(std::vector<ResidualTrace>* trace, ResidualModels* models) const {
    for (const Rows& rows : recordings_) {
      const size_t block = options_.block_rows == 0 ? rows.size() : options_.block_rows * numbers_;
      for (size_t at = 0; at < rows.size(); at += block)
        code_block(std::span(rows).subspan(at, std::min(block, rows.size() - at)), trace, models);
    }
  }

  void code_block(std::span<const double> rows, std::vector<ResidualTrace>* trace,
                  ResidualModels* models) const {
    NumberRowCoder coder(model_);
    BinaryListener listener;
    coder.trace_to(trace);
    if (models != nullptr) std::swap(coder.models(), *models);
    std::vector<double> row(numbers_);
    for (size_t at = 0; at < rows.size(); at += numbers_) {
      std::ranges::copy(rows.subspan(at, numbers_), row.begin());
      coder.code(listener, row);
    }
    if (models != nullptr) std::swap(coder.models(), *models);
  }

  void fit_usual_scales(std::span<const ResidualTrace> trace) {
    std::vector<double> sums(model_.channels.size()), counts(model_.channels.size());
    for (const ResidualTrace& sample : trace) {
      if (sample.is_first) continue;
      sums[sample.channel] += std::abs(static_cast<double>(sample.residual));
      counts[sample.channel] += 1;
    }
    for (size_t i = 0; i < sums.size(); ++i)
      if (counts[i] > 0)
        model_.channels[i].usual_scale = quarter_octaves(16 * sums[i] / counts[i], 0, 64);
  }

  void learn_starts() {
    ResidualModels models(model_);
    for (int i = 0; i < kPasses; ++i) pass(nullptr, &models);
    models.store(model_);
  }

  NumberModel model_;
  size_t numbers_;
  NumberTraining options_;
  std::vector<Rows> recordings_;
};

}  // namespace

Status NumberTraining::validate() const {
  if (max_terms > NumberChannel::kMaxTerms)
    return invalid_argument("number training: {} terms, needs at most {}", max_terms,
                            NumberChannel::kMaxTerms);
  if (max_rows == 0) return invalid_argument("number training: no rows, needs one");
  if (!(min_gain_bits >= 0))
    return invalid_argument("number training: gain of {} bits, needs 0 or more", min_gain_bits);
  return {};
}

Result<NumberModel> train_number_model(std::vector<NumberField> fields,
                                       std::span<const std::vector<double>> recordings,
                                       const NumberTraining& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(NumberModel model, NumberModel::create(std::move(fields)));
  const size_t numbers = model.count();
  if (numbers == 0) return model;
  for (const std::vector<double>& recording : recordings)
    if (recording.size() % numbers != 0)
      return invalid_argument("number training: recording of {} numbers, needs rows of {}",
                              recording.size(), numbers);
  return Training(std::move(model), recordings, options).run();
}

}  // namespace engram::encoders
