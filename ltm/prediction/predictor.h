// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/memory/result.h"

namespace engram::ltm {

/// The name of the engine that repeats the last value.
inline constexpr std::string_view kCopyLast = "copy-last";

/// The inputs that a prediction starts from.
struct Past {
  Past() = default;
  // The constructors are implicit because most predictions start from values alone.
  // NOLINTBEGIN(google-explicit-constructor)
  Past(std::span<const idf::Data> past, std::span<const idf::Data> known = {})
      : values(past), conditions(known) {}
  Past(const std::vector<idf::Data>& past) : values(past) {}
  // NOLINTEND(google-explicit-constructor)

  std::span<const idf::Data> values;  ///< Of the entity, oldest first.
  /// Values of Predictor::condition(), one for each of `values`: the last one at or before its
  /// time. Empty if one is missing.
  std::span<const idf::Data> conditions;
  /// Planned values of the condition for 1, 2, ... steps after the last of `values`. Beyond its end
  /// a plan repeats its last value. Empty without a plan; ignored without `conditions`.
  std::span<const idf::Data> plan;
};

/// The inputs that a prediction has in addition to the past of its entity.
enum class PredictorInputs {
  kValues,      ///< None.
  kConditions,  ///< The past of Predictor::condition().
  kPlan,        ///< The past of Predictor::condition() and its planned values.
};

/// The error that is expected of a prediction before the truth is known. NaN if it is unknown.
struct ErrorEstimate {
  MeasuredError expected;  ///< The mean.
  MeasuredError bound;     ///< The true error stays within it, with kBoundProbability.

  friend bool operator==(const ErrorEstimate&, const ErrorEstimate&) = default;
};

struct Prediction {
  idf::Data value;
  ErrorEstimate error;
  /// Share of the last known value in the prediction, 0 to 1: a model may copy what it cannot
  /// predict. With 1, the members of that kind equal those of the last value bit for bit.
  double copied_images = 0;
  double copied_numbers = 0;
};

/// The errors of predictions at one number of steps, measured on data that the model was not
/// trained on.
struct HorizonRecord {
  int steps = 0;
  uint64_t predictions = 0;  ///< Number of measured predictions.
  MeasuredError mean;        ///< Mean error of these predictions.
};

/// Predicts the next values of one entity from its past.
///
/// Threading: one thread.
class Predictor {
 public:
  virtual ~Predictor() = default;

  /// The engine's name in answers: "copy-last" or "deep".
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Interval between the snapshots that it was trained on; zero if it accepts any interval.
  [[nodiscard]] virtual Duration step() const = 0;

  /// Number of past snapshots that it uses. It accepts fewer but needs at least one.
  [[nodiscard]] virtual size_t context() const = 0;

  /// Another entity whose past improves the predictions; nothing if there is none.
  [[nodiscard]] virtual std::optional<MemoryId> condition() const { return std::nullopt; }

  /// Predicts the values at 1..`steps` steps after the last of `past`, with their error estimates.
  /// Errors: kInvalidArgument if a value or a planned value has another layout than the model's.
  virtual Result<std::vector<Prediction>> predict(const Past& past, int steps) = 0;

  /// Predicts only the values at the given steps, in the order of `steps`. The steps between need
  /// not be decoded to values, and decoding is most of the cost of a prediction.
  /// Needs at least one step, each at least 1.
  /// Errors: as predict().
  virtual Result<std::vector<Prediction>> predict_at(const Past& past, std::span<const int> steps);

  /// Records sorted by steps; empty if nothing was measured.
  [[nodiscard]] virtual std::vector<HorizonRecord> records(PredictorInputs /*told*/) const {
    return {};
  }
};

/// A predictor that answers with the last value: the baseline for every other predictor.
[[nodiscard]] std::unique_ptr<Predictor> make_copy_last_predictor();

}  // namespace engram::ltm
