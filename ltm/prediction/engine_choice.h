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

/// A way to predict an entity.
struct Engine {
  Predictor* predictor = nullptr;  ///< Never null; who gave it owns it.
  std::string model;               ///< "Vision/RGB/head/cam v1"; empty without one.
};

/// What an engine was worth on the recent past of an entity, one horizon ahead.
struct EngineRecord {
  std::string engine;
  std::string model;         ///< Of Engine::model.
  uint64_t predictions = 0;  ///< That it was measured on; zero: nothing is known.
  MeasuredError mean;        ///< Their mean error.
  MeasuredError bound;       ///< That of one is at most that, with kBoundProbability.
};

/// Predicts one entity by whichever engine was best on its own past, per horizon.
///
/// Threading: one thread.
/// Source: docs/prediction.md.
class EngineChoice {
 public:
  virtual ~EngineChoice() = default;

  /// How many snapshots before and with this one are worth adding: all that is learned and
  /// measured from.
  [[nodiscard]] virtual size_t snapshots_wanted(const Snapshot& newest) const = 0;

  /// What came next. Errors: kInvalidArgument where it is not after the last one.
  virtual Status add(const Snapshot& snapshot) = 0;

  /// From the last snapshot on, one answer per horizon in their order, by the engine that is named
  /// or (empty) by the best for each. It tells engine, model, horizon, expected error and bound.
  /// Errors: kNotFound without a snapshot or where no engine has this name, naming those there
  /// are; kInvalidArgument where a horizon is not positive; those of the engine.
  virtual Result<std::vector<SnapshotResult>> predict(std::span<const Duration> horizons,
                                                      const std::string& engine) = 0;

  /// All engines, measured that far ahead, the one that answers first.
  virtual Result<std::vector<EngineRecord>> records(Duration ahead) = 0;
};

/// What Predictor::condition() was at a moment: the last value at or before it, or nothing.
using ConditionAt = std::function<Result<std::optional<idf::Data>>(const MemoryId&, Time)>;

/// What a choice is made for.
struct EngineChoiceInputs {
  MemoryId entity;
  std::optional<idf::Type> type;  ///< Of its values.
  std::vector<Engine> models;     ///< Outlive the choice.
  ConditionAt condition_at;       ///< May be empty: then no condition is known.
};

/// Given from above, so that recall needs to know no other engines than those of its models.
using MakeEngineChoice = std::function<std::unique_ptr<EngineChoice>(EngineChoiceInputs)>;

}  // namespace engram::ltm
