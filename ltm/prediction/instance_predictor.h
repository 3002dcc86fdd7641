// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/prediction/instance_history.h"
#include "ltm/prediction/member_choice.h"
#include "ltm/prediction/model_rollouts.h"
#include "ltm/prediction/series_predictor.h"

namespace engram::ltm {

/// Predicts the values of one instance of an entity: each member with the engine that was best for
/// it, or all members with one named engine.
///
/// Numbers are predicted by the series engines or by a model, images and large arrays only by a
/// model. Members that no engine predicts are copied. All engines are measured on the same moments,
/// in the last third of what is kept (InstanceHistory::Window). Moments when a member moved are
/// measured apart from those when it was at rest (MemberMotion).
/// Threading: one thread.
/// Source: docs/prediction.md, section "Which engine answers".
class InstancePredictor {
 public:
  /// `inputs` must outlive it.
  explicit InstancePredictor(const EngineChoiceInputs& inputs);

  /// Adds a value; `time` must be after that of the last one (checked).
  void add(Time time, const idf::Data& value);

  /// The number of values like this one that are used. Adding more is of no use.
  [[nodiscard]] size_t values_wanted(const idf::Data& value) const {
    return history_.values_wanted(value);
  }

  /// The names of all engines: models first, then copy-last and the other series engines.
  [[nodiscard]] std::vector<std::string> engines() const;

  /// The same engines with their errors at the horizon `ahead`, over all members that count.
  Result<std::vector<EngineRecord>> records(Duration ahead);

  /// Returns one prediction per horizon, in their order. With an empty `engine` each member is
  /// predicted by its best engine, else by the named one if it can; the rest is copied. A model
  /// runs once for all horizons.
  /// Errors: those of a model.
  Result<std::vector<InstancePrediction>> predict(std::span<const Duration> horizons,
                                                  const std::string& engine);

  /// See EngineChoice::by_model.
  Result<InstancePrediction> by_model(const Engine& model, const Prediction& predicted);

 private:
  /// The choice of engines for one horizon.
  struct Plan {
    std::vector<MemberCandidate> candidates;
    std::vector<MemberChoice> choices;  ///< One per member of the layout.
  };

  [[nodiscard]] std::vector<MeasuredError> copied_errors(size_t steps) const;
  std::vector<EngineRecord> series_records(Duration ahead);
  Result<EngineRecord> model_record(const Engine& model, Duration ahead);
  Status measure_models(std::span<const Duration> horizons, const std::string& engine);
  Result<std::vector<std::pair<size_t, MemberErrors>>> model_errors(const Engine& model,
                                                                    Duration ahead);
  std::vector<MemberCandidate> series_candidates(Duration ahead, const std::string& engine);
  Result<MemberCandidate> model_candidate(const Engine& model, Duration ahead);
  Result<Plan> plan(Duration ahead, const std::string& engine, const std::vector<bool>& is_moving);
  Result<InstancePrediction> joined(Duration ahead, const Plan& plan,
                                    const std::vector<bool>& is_moving,
                                    const std::map<const Engine*, Prediction>& models);
  [[nodiscard]] std::vector<bool> moving(size_t row);

  const EngineChoiceInputs& inputs_;
  InstanceHistory history_;
  ModelRollouts rollouts_;
  std::unique_ptr<SeriesPredictor> predictor_;
};

}  // namespace engram::ltm
