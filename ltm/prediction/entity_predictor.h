// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"

namespace engram::ltm {

class InstancePredictor;

/// Predicts an entity, whatever its values are: each member by the engine that was best on its own
/// past.
///
///     EntityPredictor predictor({entity, type});  // Once per entity.
///     ENGRAM_RETURN_IF_ERROR(predictor.add(snapshot));    // With every snapshot that comes.
///     const std::vector<Duration> horizons{200ms, 1s};
///     ENGRAM_ASSIGN_OR_RETURN(auto predicted, predictor.predict(horizons, ""));
///
/// Adding costs microseconds for numbers and reads some 16,000 elements of images; engines learn
/// and are measured when a prediction is asked for (up to a second for a hundred numbers or for a
/// model), again when a tenth more snapshots have come.
/// Engines: copy-last; for values with numbers those of make_series_engines(), which copy the rest;
/// the entity's models. Each member of each instance has the one that was best for it, at rest or
/// moving as it is (InstancePredictor); SnapshotResult::predictor names the one, or says "mixed".
/// Time: a horizon between two steps of the entity lies on the straight line between what is
/// predicted for these; models and errors are those of the closest step.
/// Threading: one thread.
/// Source: docs/prediction.md.
class EntityPredictor final : public EngineChoice {
 public:
  /// Predictors in `inputs` outlive it.
  explicit EntityPredictor(EngineChoiceInputs inputs);
  ~EntityPredictor() override;

  [[nodiscard]] size_t snapshots_wanted(const Snapshot& newest) const override;

  /// Errors: kInvalidArgument where `snapshot` is of another entity or not after the last one; then
  /// it is left out.
  Status add(const Snapshot& snapshot) override;

  Result<std::vector<SnapshotResult>> predict(std::span<const Duration> horizons,
                                              const std::string& engine) override;

  /// Means over the instances; bounds are the largest of one.
  Result<std::vector<EngineRecord>> records(Duration ahead) override;

 private:
  [[nodiscard]] std::vector<std::string> engines() const;

  EngineChoiceInputs inputs_;
  std::vector<std::unique_ptr<InstancePredictor>> instances_;  ///< By index.
  std::vector<InstanceMetadata> metadata_;  ///< Of the instances of the last snapshot.
  std::optional<Time> last_;
};

/// Usable as MakeEngineChoice.
[[nodiscard]] std::unique_ptr<EngineChoice> make_entity_predictor(EngineChoiceInputs inputs);

}  // namespace engram::ltm
