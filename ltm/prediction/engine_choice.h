// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/prediction/predictor.h"

namespace engram::ltm {

/// An engine that predicts an entity.
struct Engine {
  Predictor* predictor = nullptr;  ///< Never null; not owned.
  std::string model;               ///< "Vision/RGB/head/cam v1"; empty without a model.
};

/// The measured errors of an engine on the recent past of an entity, at one horizon.
struct EngineRecord {
  std::string engine;
  std::string model;         ///< Engine::model.
  uint64_t predictions = 0;  ///< Number of measured predictions; with 0 the errors are unknown.
  MeasuredError mean;        ///< Mean error of these predictions.
  MeasuredError bound;       ///< One prediction stays within it, with kBoundProbability.
};

/// The prediction of one instance.
struct InstancePrediction {
  idf::Data value;
  std::string model;                      ///< Engine::model; empty if no model predicted.
  ErrorEstimate error;                    ///< Over all members that count.
  std::vector<MemberPrediction> members;  ///< In the order of the layout.
};

/// Predicts one entity, for each horizon with the engine that was best on the entity's own past.
///
/// Threading: one thread.
/// Source: docs/prediction.md.
class EngineChoice {
 public:
  virtual ~EngineChoice() = default;

  /// The number of snapshots, up to and including `newest`, that engines learn from or are measured
  /// on. Adding more is of no use.
  [[nodiscard]] virtual size_t snapshots_wanted(const Snapshot& newest) const = 0;

  /// Adds the next snapshot. Errors: kInvalidArgument if it is not after the last one.
  virtual Status add(const Snapshot& snapshot) = 0;

  /// Predicts from the last snapshot on and returns one answer per horizon, in their order. The
  /// engine with the given name predicts or, if it is empty, the best one for each horizon. Answers
  /// have the engine, model, horizon, expected error and bound.
  /// Errors: kNotFound without a snapshot, or if no engine has this name (it lists the known ones);
  /// kInvalidArgument if a horizon is not positive; those of the engine.
  virtual Result<std::vector<SnapshotResult>> predict(std::span<const Duration> horizons,
                                                      const std::string& engine) = 0;

  /// Tells of each member what `model` predicted for an instance of the last snapshot when it was
  /// told what the choice does not know: a plan. Members that no engine predicts are copied. The
  /// errors are those that the model told. By default no members are told.
  /// Errors: kNotFound if the last snapshot has no such instance.
  virtual Result<InstancePrediction> by_model(size_t /*instance*/, const Engine& model,
                                              const Prediction& predicted) {
    return InstancePrediction{predicted.value, model.model, predicted.error, {}};
  }

  /// All engines with their errors at the horizon `ahead`. The one that answers comes first.
  virtual Result<std::vector<EngineRecord>> records(Duration ahead) = 0;
};

/// Returns the value of an entity (Predictor::condition) at a moment: the last one at or before it,
/// or nothing.
using ConditionAt = std::function<Result<std::optional<idf::Data>>(const MemoryId&, Time)>;

/// The inputs that an EngineChoice is made from.
struct EngineChoiceInputs {
  MemoryId entity;
  std::optional<idf::Type> type;  ///< The declared type of its values.
  std::vector<Engine> models;     ///< They must outlive the choice.
  ConditionAt condition_at;       ///< If it is empty, no condition is known.
};

/// Makes an EngineChoice. The caller of recall provides it, so that recall need not know engines
/// other than those of its models.
using MakeEngineChoice = std::function<std::unique_ptr<EngineChoice>(EngineChoiceInputs)>;

}  // namespace engram::ltm
