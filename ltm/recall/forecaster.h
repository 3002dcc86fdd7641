// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/recall/engine_choice.h"
#include "ltm/recall/past_reader.h"

namespace engram::ltm {

/// What is to be predicted, and from when on.
struct Outlook {
  /// The last moment that is known: later snapshots are not looked at. Nothing: the newest one.
  std::optional<Time> from;
  /// From the last snapshot that is known on. At least one; each is taken as the closest number
  /// of steps of the engine, at least one.
  std::vector<Duration> horizons;
  std::string engine;  ///< By the name of its predictor; empty: the first of engines().
  /// Entity whose snapshots after the last known moment are planned values of the engine's
  /// condition (Predictor::condition), of its layout. The condition itself: what really came of
  /// it, in hindsight. Nothing: no plan is told.
  std::optional<MemoryId> plan{};
};

/// Predicts entities of a store from their past.
///
/// Threading: one thread.
class Forecaster {
 public:
  /// `past` outlives it.
  explicit Forecaster(PastReader& past) : past_(past) {}

  /// See Recall::engines().
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// See Recall::engine().
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// See Recall::predict(). `prefer`: what the past is read from; `max_steps`: how far a prediction
  /// may reach.
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity, const Outlook& outlook,
                                              Prefer prefer, int max_steps);

 private:
  Result<std::vector<SnapshotResult>> read_all(const MemoryId& entity,
                                               std::span<const SnapshotEntry> entries,
                                               Prefer prefer);
  Result<std::vector<idf::Data>> conditions_of(const Predictor& predictor,
                                               std::span<const SnapshotEntry> entries,
                                               Prefer prefer);
  Result<std::vector<idf::Data>> plan_of(const Predictor& predictor, const MemoryId& entity,
                                         Time last, size_t steps, Prefer prefer);

  PastReader& past_;
  std::unique_ptr<Predictor> copy_last_ = make_copy_last_predictor();
};

}  // namespace engram::ltm
