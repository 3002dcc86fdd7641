// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"

namespace engram::ltm {

class InstancePredictor;

/// Predicts an entity with values of any type: each member with the engine that was best on the
/// member's own past.
///
///     EntityPredictor predictor({entity, type});  // Once per entity.
///     ENGRAM_RETURN_IF_ERROR(predictor.add(snapshot));    // With every snapshot that comes.
///     const std::vector<Duration> horizons{200ms, 1s};
///     ENGRAM_ASSIGN_OR_RETURN(auto predicted, predictor.predict(horizons, ""));
///
/// Adding a snapshot costs microseconds for numbers and reads some 16,000 elements of an image.
/// Engines learn and are measured when a prediction is requested (up to half a second for a hundred
/// numbers or for a model), and again after a tenth more snapshots.
/// Engines: copy-last; for values with numbers those of make_series_engines(), which copy the rest;
/// the entity's models. Each member of each instance uses the engine that was best for it in its
/// present state, at rest or moving (InstancePredictor). SnapshotResult::predictor names the
/// engine, or is "mixed" if there are several.
/// Time: a prediction for a horizon between two steps of the entity is interpolated linearly
/// between the two; models and errors are those of the closest step.
/// Threading: one thread.
/// Source: docs/prediction.md.
class EntityPredictor final : public EngineChoice {
 public:
  /// The predictors in `inputs` must outlive it.
  explicit EntityPredictor(EngineChoiceInputs inputs);
  ~EntityPredictor() override;

  [[nodiscard]] size_t snapshots_wanted(const Snapshot& newest) const override;

  /// Errors: kInvalidArgument if `snapshot` is of another entity or not after the last one; then it
  /// is not added.
  Status add(const Snapshot& snapshot) override;

  Result<std::vector<SnapshotResult>> predict(std::span<const Duration> horizons,
                                              const std::string& engine) override;

  Result<InstancePrediction> by_model(size_t instance, const Engine& model,
                                      const Prediction& predicted) override;

  /// Errors are means over the instances; bounds are the largest bound of an instance.
  Result<std::vector<EngineRecord>> records(Duration ahead) override;

 private:
  [[nodiscard]] std::vector<std::string> engines() const;

  EngineChoiceInputs inputs_;
  std::vector<std::unique_ptr<InstancePredictor>> instances_;  ///< By instance index.
  std::vector<InstanceMetadata> metadata_;  ///< Of the instances in the last snapshot.
  std::optional<Time> last_;
};

/// The engine of a whole answer whose members are told: the named one if it predicted anything,
/// else the only one that did, else "mixed"; "copy-last" if the answer holds nothing but copies.
[[nodiscard]] std::string engine_of(const SnapshotResult& predicted, const std::string& named);

/// Makes an EntityPredictor. Usable as MakeEngineChoice.
[[nodiscard]] std::unique_ptr<EngineChoice> make_entity_predictor(EngineChoiceInputs inputs);

}  // namespace engram::ltm
