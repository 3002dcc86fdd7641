// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>

#include "ltm/prediction/instance_history.h"

// Private to this room.

namespace engram::ltm {

/// What models predict of one instance, and how wrong that was on its past: each model runs once
/// for all moments that are asked for together, and what it said is kept until the next value
/// comes.
///
/// Threading: one thread.
class ModelRollouts {
 public:
  /// Bytes of predicted values that are kept of all models: pictures of a minute are not.
  static constexpr size_t kMaxKeptBytes = size_t{16} << 20;

  /// Both outlive it.
  ModelRollouts(const EngineChoiceInputs& inputs, const InstanceHistory& history)
      : inputs_(inputs), history_(history) {}

  /// After each value that came.
  void on_added(bool is_new_layout);

  /// From the last value, so many steps of the model ahead, in the order of `steps`.
  /// Errors: those of the model.
  Result<std::vector<Prediction>> ahead(const Engine& model, std::span<const int> steps);

  /// Of predictions from an earlier row that has its value, for each of `steps`; nothing where no
  /// row is known then. Errors: those of the model; kInvalidArgument where values have another
  /// layout than the model's.
  Result<std::vector<std::optional<MemberErrors>>> errors(const Engine& model, size_t row,
                                                          std::span<const int> steps);

 private:
  Result<std::vector<Prediction>> from(const Engine& model, size_t value,
                                       std::span<const int> steps) const;

  const EngineChoiceInputs& inputs_;
  const InstanceHistory& history_;
  /// By the model's name and its steps.
  std::map<std::pair<std::string, int>, Prediction> kept_;
  size_t kept_bytes_ = 0;
  /// By the row (counted with those that are gone), the model's name and its steps.
  std::map<std::tuple<uint64_t, std::string, int>, std::optional<MemberErrors>> errors_;
};

/// The number of the model's steps that comes closest, at least one.
[[nodiscard]] int model_steps(const Predictor& predictor, Duration ahead);

}  // namespace engram::ltm
