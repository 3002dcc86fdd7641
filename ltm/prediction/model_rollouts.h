// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>

#include "ltm/prediction/instance_history.h"

// Private to this room.

namespace engram::ltm {

/// Runs models on one instance, and measures their errors on its past. Each model runs once for all
/// steps that are requested together, and its predictions are kept until the next value comes.
///
/// Threading: one thread.
class ModelRollouts {
 public:
  /// Max bytes of predicted values that are kept, over all models. A minute of images needs more
  /// and is not kept.
  static constexpr size_t kMaxKeptBytes = size_t{16} << 20;

  /// Both must outlive it.
  ModelRollouts(const EngineChoiceInputs& inputs, const InstanceHistory& history)
      : inputs_(inputs), history_(history) {}

  /// Call it after each value that was added to the history.
  void on_added(bool is_new_layout);

  /// Predicts from the last value, for each of `steps`, in their order. Unit: steps of the model.
  /// Errors: those of the model.
  Result<std::vector<Prediction>> ahead(const Engine& model, std::span<const int> steps);

  /// The errors of predictions from an earlier row whose value is kept, for each of `steps`.
  /// Nothing for a step that has no row yet, or whose row is in another run.
  /// Errors: those of the model; kInvalidArgument if values have another layout than the model.
  Result<std::vector<std::optional<MemberErrors>>> errors(const Engine& model, size_t row,
                                                          std::span<const int> steps);

 private:
  Result<std::vector<Prediction>> from(const Engine& model, size_t value,
                                       std::span<const int> steps) const;

  const EngineChoiceInputs& inputs_;
  const InstanceHistory& history_;
  /// The key is the model's name and the number of steps.
  std::map<std::pair<std::string, int>, Prediction> kept_;
  size_t kept_bytes_ = 0;
  /// The key is the row (counted from the first one ever added), the model's name and the number of
  /// steps.
  std::map<std::tuple<uint64_t, std::string, int>, std::optional<MemberErrors>> errors_;
};

/// The number of the model's steps that is closest to `ahead`, at least one.
[[nodiscard]] int model_steps(const Predictor& predictor, Duration ahead);

}  // namespace engram::ltm
