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

/// What one instance will be.
struct InstancePrediction {
  idf::Data value;
  std::string model;                      ///< Of Engine::model; empty where none predicted.
  ErrorEstimate error;                    ///< Of what counts, over all members.
  std::vector<MemberPrediction> members;  ///< In the order of the layout.
};

/// Continues the values of one instance of an entity: each member by the engine that was best for
/// it, or all by one that is named.
///
/// Numbers are continued by the engines of their series or by a model, images and large arrays by a
/// model or not at all; what no engine continues is copied. All are measured on the same moments of
/// the last third of what is kept (InstanceHistory::Window), those when a member moved apart from
/// those when it was at rest (MemberMotion).
/// Threading: one thread.
/// Source: docs/prediction.md, section "Which engine answers".
class InstancePredictor {
 public:
  /// `inputs` outlives it.
  explicit InstancePredictor(const EngineChoiceInputs& inputs);

  /// `time` comes after that of the last one (checked).
  void add(Time time, const idf::Data& value);

  /// How many values like this are worth adding.
  [[nodiscard]] size_t values_wanted(const idf::Data& value) const {
    return history_.values_wanted(value);
  }

  /// All engines, models first, then the last value.
  [[nodiscard]] std::vector<std::string> engines() const;

  /// The same, measured that far ahead, over all that counts.
  Result<std::vector<EngineRecord>> records(Duration ahead);

  /// One for each horizon in their order, by the best engine for each member, or (not empty) by the
  /// named one as far as it continues them; the rest is copied. A model runs once for all horizons.
  /// Errors: those of a model.
  Result<std::vector<InstancePrediction>> predict(std::span<const Duration> horizons,
                                                  const std::string& engine);

 private:
  /// One horizon, decided.
  struct Plan {
    std::vector<MemberCandidate> candidates;
    std::vector<MemberChoice> choices;  ///< By member of the layout.
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
