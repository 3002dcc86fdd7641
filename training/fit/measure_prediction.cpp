// SPDX-License-Identifier: Apache-2.0
#include "training/fit/measure_prediction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "training/fit/conformal.h"
#include "training/fit/windows.h"
#include "training/quality/psnr.h"

namespace engram::training {

using encoders::BlendShares;
using encoders::Parts;
using encoders::PredictionRecord;
using torch::Tensor;

namespace {

constexpr size_t kHorizons = encoders::kMeasuredHorizons;
constexpr size_t kMaxWindows = 256;
constexpr std::array<double, 5> kGates{0.0, 0.25, 0.5, 0.75, 1.0};
/// Min change of an image, which noise alone causes. Unit: squared grey levels.
constexpr double kMinImageChange = 1.0;
/// Min gain of a prediction with latents over one by motion alone. The autoencoder was trained on
/// the held-out windows too, so latents look better here than on new recordings. Unit: dB.
/// Chosen on five recordings that were left out (docs/learning_methods.md, "Prediction").
constexpr double kMinGainOfLatents = 0.5;
/// Min change of numbers, in their deviations.
constexpr double kMinNumberChange = 0.01;

/// The tried shares of latents and of motion, whose sum is at most 1. The first pair copies.
std::vector<BlendShares> image_shares() {
  std::vector<BlendShares> shares;
  for (const double latents : kGates)
    for (const double motion : kGates)
      if (latents + motion <= 1) shares.push_back({latents, motion, 0});
  return shares;
}

/// Mean squared errors of windows at one horizon, by share and window.
struct HorizonErrorsByShare {
  std::vector<ltm::MeasuredError> changes;   ///< Per window: change of its last two values.
  std::vector<std::vector<double>> images;   ///< By image_shares().
  std::vector<std::vector<double>> numbers;  ///< By kGates.

  void add(const encoders::DeepModel& model, const std::vector<BlendShares>& shares,
           const Parts& last, const ltm::MeasuredError& change, const encoders::Future& future,
           const Parts& actual) {
    changes.push_back(change);
    images.resize(shares.size());
    numbers.resize(kGates.size());
    for (size_t i = 0; i < shares.size() && !last.images.empty(); ++i)
      images[i].push_back(image_error(model, encoders::mix(last, future, shares[i]), actual));
    for (size_t i = 0; i < kGates.size() && last.numbers.defined(); ++i)
      numbers[i].push_back(
          number_error(model, encoders::mix(last, future, {0, 0, kGates[i]}), actual));
  }

  /// Adds a window whose only share is that of a copy.
  void add_copy(const encoders::DeepModel& model, const Parts& last,
                const ltm::MeasuredError& change, const Parts& actual) {
    changes.push_back(change);
    images.resize(1);
    numbers.resize(1);
    const ltm::MeasuredError error = model.difference(last, actual);
    if (!last.images.empty()) images[0].push_back(error.image_mse);
    if (last.numbers.defined()) numbers[0].push_back(error.number_mse);
  }

 private:
  static double image_error(const encoders::DeepModel& model, Parts predicted, Parts actual) {
    for (Tensor& image : predicted.images) image = image.round().clamp(0, 255);
    return model.difference(predicted, actual).image_mse;
  }

  static double number_error(const encoders::DeepModel& model, Parts predicted, Parts actual) {
    predicted.images = actual.images;
    return model.difference(predicted, actual).number_mse;
  }
};

/// Shares are chosen on every other window, and errors are measured on the windows in between.
bool is_for_choosing(size_t window) {
  return window % 2 == 0;
}

/// Index of the shares with the highest mean PSNR whose squared error is not above that of the
/// first ones.
size_t best_for_images(const std::vector<BlendShares>& shares,
                       const std::vector<std::vector<double>>& errors) {
  size_t best = 0;
  double copied_mse = 0, best_psnr = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    double mse = 0, psnr = 0;
    for (size_t window = 0; window < errors[i].size(); ++window) {
      if (!is_for_choosing(window)) continue;
      mse += errors[i][window];
      psnr += psnr_db(errors[i][window]) - (shares[i].latents > 0 ? kMinGainOfLatents : 0);
    }
    if (i == 0) copied_mse = mse;
    const bool is_better = i == 0 || (psnr > best_psnr && mse <= copied_mse);
    if (!is_better) continue;
    best = i;
    best_psnr = psnr;
  }
  return best;
}

size_t best_for_numbers(const std::vector<std::vector<double>>& errors) {
  size_t best = 0;
  double min = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    double mse = 0;
    for (size_t window = 0; window < errors[i].size(); ++window)
      if (is_for_choosing(window)) mse += errors[i][window];
    if (i > 0 && mse >= min) continue;
    best = i;
    min = mse;
  }
  return best;
}

std::vector<MeasuredPrediction> paired(const std::vector<double>& changes,
                                       const std::vector<double>& errors) {
  std::vector<MeasuredPrediction> pairs;
  for (size_t window = 0; window < errors.size(); ++window)
    pairs.push_back({changes[window], errors[window]});
  return pairs;
}

/// Errors by window and, if known, those of copies in the same windows and in all windows.
struct Errors {
  std::vector<MeasuredPrediction> own, copied, copied_everywhere;
};

encoders::ErrorCalibration calibration_of(const Errors& errors, double min_change) {
  std::vector<MeasuredPrediction> choosing, calibrating;
  for (size_t window = 0; window < errors.own.size(); ++window)
    (is_for_choosing(window) ? choosing : calibrating).push_back(errors.own[window]);
  encoders::ErrorCalibration by = calibrate(choosing, calibrating, min_change);
  widen(by, errors.copied_everywhere, errors.copied);
  return by;
}

/// Min change of numbers, in their units.
double min_number_change(const encoders::DeepModel& model) {
  double sum = 0;
  for (const double deviation : model.deviation) sum += deviation * deviation;
  const auto count = static_cast<double>(std::max<size_t>(model.deviation.size(), 1));
  return std::max(kMinNumberChange * kMinNumberChange * sum / count,
                  std::numeric_limits<double>::min());
}

/// Changes of images and of numbers before each window.
std::pair<std::vector<double>, std::vector<double>> changes_of(
    const HorizonErrorsByShare& measured) {
  std::pair<std::vector<double>, std::vector<double>> changes;
  for (const ltm::MeasuredError& change : measured.changes) {
    changes.first.push_back(change.image_mse);
    changes.second.push_back(change.number_mse);
  }
  return changes;
}

/// Errors of copies, which are those of the first share; empty if nothing was measured.
std::vector<double> of_copies(const std::vector<std::vector<double>>& by_share) {
  return by_share.empty() ? std::vector<double>() : by_share.front();
}

/// The errors of these shares. `copied` are copies in all windows.
encoders::HorizonErrors errors_of(const encoders::DeepModel& model,
                                  const HorizonErrorsByShare& measured,
                                  const HorizonErrorsByShare& copied, size_t image, size_t number) {
  const auto [image_changes, number_changes] = changes_of(measured);
  const auto [all_image_changes, all_number_changes] = changes_of(copied);
  const Errors images{paired(image_changes, measured.images[image]),
                      paired(image_changes, measured.images[0]),
                      paired(all_image_changes, of_copies(copied.images))};
  const Errors numbers{paired(number_changes, measured.numbers[number]),
                       paired(number_changes, measured.numbers[0]),
                       paired(all_number_changes, of_copies(copied.numbers))};
  return {calibration_of(images, kMinImageChange),
          calibration_of(numbers, min_number_change(model))};
}

using Measured = std::array<HorizonErrorsByShare, kHorizons>;

/// Keeps the best shares, or copies, and their errors. `copied` are copies in all windows.
void keep(const encoders::DeepModel& model, const Measured& measured, const Measured& copied,
          PredictionRecord& record) {
  const std::vector<BlendShares> shares = image_shares();
  for (size_t i = 0; i < kHorizons; ++i) {
    if (measured[i].changes.empty()) {
      // A horizon that no recording is long enough for gets the errors of the last measured one.
      if (i > 0) record.errors[i] = record.errors[i - 1];
      for (encoders::ErrorCalibration* errors :
           {&record.errors[i].images, &record.errors[i].numbers}) {
        errors->bound_per_scale = std::numeric_limits<double>::quiet_NaN();
        errors->measured = 0;
      }
      continue;
    }
    const size_t image = best_for_images(shares, measured[i].images);
    const size_t number = best_for_numbers(measured[i].numbers);
    record.image_gates[i] = shares[image].latents;
    record.motion_gates[i] = shares[image].motion;
    record.number_gates[i] = kGates[number];
    record.errors[i] = errors_of(model, measured[i], copied[i], image, number);
  }
}

Tensor index_of(int64_t row) {
  return torch::tensor({row}, torch::kLong);
}

/// Number of horizons with a known value after a row.
size_t steps_after(const Dataset& data, int64_t row) {
  const auto sequence = std::find_if(data.sequences.begin(), data.sequences.end(),
                                     [&](auto& s) { return static_cast<size_t>(row) < s.end; });
  return std::min<size_t>(kHorizons, sequence->end - 1 - static_cast<size_t>(row));
}

/// Measures copies on all windows. They learn nothing, so training data is valid for them.
Measured measure_copies(const encoders::DeepModel& model, const Dataset& data) {
  const auto& shape = model.autoencoder->shape;
  auto [rows, held_out] = make_windows(data.sequences, data.first_held_out, 1);
  rows.insert(rows.end(), held_out.begin(), held_out.end());
  std::ranges::sort(rows);
  const size_t stride = std::max<size_t>(1, rows.size() / kMaxWindows);
  Measured measured;
  for (size_t w = 0; w < rows.size(); w += stride) {
    const int64_t row = rows[w];
    const Parts last = data.batch(shape, index_of(row));
    const auto change = model.difference(last, data.batch(shape, index_of(row - 1)));
    for (size_t i = 0; i < steps_after(data, row); ++i)
      measured[i].add_copy(model, last, change,
                           data.batch(shape, index_of(row + static_cast<int64_t>(i) + 1)));
  }
  return measured;
}

/// Measures predictions on held-out windows.
Measured measure(encoders::DeepModel& model, const Dataset& data, ltm::PredictorInputs told) {
  const auto& shape = model.autoencoder->shape;
  const std::vector<BlendShares> shares = image_shares();
  const std::vector<int64_t> rows = make_windows(data.sequences, data.first_held_out, 1).held_out;
  const size_t stride = std::max<size_t>(1, rows.size() / kMaxWindows);
  Measured measured;
  for (size_t w = 0; w < rows.size(); w += stride) {
    const int64_t row = rows[w];
    const auto steps = static_cast<int>(steps_after(data, row));
    Parts last = data.batch(shape, index_of(row));
    Parts before = data.batch(shape, index_of(row - 1));
    if (told == ltm::PredictorInputs::kValues) last.conditions = before.conditions = Tensor();
    if (told == ltm::PredictorInputs::kPlan)
      last.plan = data.conditions.slice(0, row + 1, row + 1 + steps).unsqueeze(0);
    const ltm::MeasuredError change = model.difference(last, before);
    const auto futures = encoders::futures_of(model, last, before, steps);
    for (size_t i = 0; i < futures.size(); ++i)
      measured[i].add(model, shares, last, change, futures[i],
                      data.batch(shape, index_of(row + static_cast<int64_t>(i) + 1)));
  }
  return measured;
}

}  // namespace

void measure_prediction(encoders::DeepModel& model, const Dataset& data) {
  torch::NoGradGuard no_grad;
  const Measured copied = measure_copies(model, data);
  keep(model, measure(model, data, ltm::PredictorInputs::kConditions), copied, model.prediction);
  if (model.condition) {
    keep(model, measure(model, data, ltm::PredictorInputs::kValues), copied, model.unconditioned);
    keep(model, measure(model, data, ltm::PredictorInputs::kPlan), copied, model.planned);
  }
  keep(model, copied, copied, model.copied);
  model.prediction.step = model.unconditioned.step = model.planned.step = model.copied.step =
      median_step(data.times);
}

}  // namespace engram::training
