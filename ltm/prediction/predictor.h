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

/// What a prediction starts from.
struct Past {
  Past() = default;
  // Most predictions start from values alone.
  // NOLINTBEGIN(google-explicit-constructor)
  Past(std::span<const idf::Data> past, std::span<const idf::Data> known = {})
      : values(past), conditions(known) {}
  Past(const std::vector<idf::Data>& past) : values(past) {}
  // NOLINTEND(google-explicit-constructor)

  std::span<const idf::Data> values;  ///< Of the entity, oldest first.
  /// Of Predictor::condition(), one for each of `values`: the last at or before its time. Empty
  /// where one is missing.
  std::span<const idf::Data> conditions;
  /// The same as planned for 1, 2, ... steps after the last of `values`; beyond its end a plan
  /// stands still. Empty without a plan; nothing without `conditions`.
  std::span<const idf::Data> plan;
};

/// What a prediction was told beside the past of its entity.
enum class PredictorInputs {
  kValues,      ///< Nothing.
  kConditions,  ///< The past of Predictor::condition().
  kPlan,        ///< And what is planned of it.
};

/// How wrong a prediction may be, told before the fact. Not a number where it is not known.
struct ErrorEstimate {
  MeasuredError expected;  ///< The mean.
  MeasuredError bound;     ///< The real one is at most that, with kBoundProbability.

  friend bool operator==(const ErrorEstimate&, const ErrorEstimate&) = default;
};

struct Prediction {
  idf::Data value;
  ErrorEstimate error;
  /// How much of the last known value is in it, 0 to 1: a model may choose to copy what it cannot
  /// tell. Where one is 1, members of that kind are those of the last value, bit for bit.
  double copied_images = 0;
  double copied_numbers = 0;
};

/// What is known of predictions so many steps ahead from data that the model was not trained on.
struct HorizonRecord {
  int steps = 0;
  uint64_t predictions = 0;  ///< That it was measured on.
  MeasuredError mean;        ///< Their mean error.
};

/// Continues the past of one entity.
///
/// Threading: one thread.
class Predictor {
 public:
  virtual ~Predictor() = default;

  /// "copy-last" or "deep": what an answer names as its engine.
  [[nodiscard]] virtual std::string_view name() const = 0;

  /// Time between two snapshots that it was trained on; zero where any will do.
  [[nodiscard]] virtual Duration step() const = 0;

  /// Past snapshots that it wants to see; fewer are accepted, at least one is needed.
  [[nodiscard]] virtual size_t context() const = 0;

  /// Another entity whose past makes predictions better; nothing where there is none.
  [[nodiscard]] virtual std::optional<MemoryId> condition() const { return std::nullopt; }

  /// The values 1..`steps` steps after the last of `past`, and how wrong they may be.
  /// Errors: kInvalidArgument where a value, or a planned one, has another layout than the model's.
  virtual Result<std::vector<Prediction>> predict(const Past& past, int steps) = 0;

  /// The values at some of the steps alone, in the order of `steps`: what lies between is passed
  /// through and need not be made a value, which is most of what a prediction costs.
  /// Needs at least one step, each at least 1. Errors: as predict().
  virtual Result<std::vector<Prediction>> predict_at(const Past& past, std::span<const int> steps);

  /// By steps; empty where nothing was measured.
  [[nodiscard]] virtual std::vector<HorizonRecord> records(PredictorInputs /*told*/) const {
    return {};
  }
};

/// A predictor that answers with the last value: the floor of every other one.
[[nodiscard]] std::unique_ptr<Predictor> make_copy_last_predictor();

}  // namespace engram::ltm
