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
  /// From the last snapshot that is known on. At least one; models take each as the closest number
  /// of their steps, at least one.
  std::vector<Duration> horizons;
  std::string engine;  ///< By its name; empty: the best for each horizon, see records().
  /// Entity whose snapshots after the last known moment are planned values of the engine's
  /// condition (Predictor::condition), of its layout. The condition itself: what really came of
  /// it, in hindsight. Nothing: no plan is told.
  std::optional<MemoryId> plan{};
};

/// Predicts entities of a store from their past.
///
/// Of the entity that was predicted last it keeps what its engines learned, and reads what came
/// since then alone. Threading: one thread.
class Forecaster {
 public:
  /// `past` outlives it. Without `make_choice` there are no engines but those of engines(), and the
  /// first of them answers; so it does where a plan is told.
  explicit Forecaster(PastReader& past, MakeEngineChoice make_choice = {})
      : past_(past), make_choice_(std::move(make_choice)) {}

  /// See Recall::engines().
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// See Recall::engine().
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// See Recall::predict(). `prefer`: what the past is read from; `max_steps`: how far a prediction
  /// may reach.
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity, const Outlook& outlook,
                                              Prefer prefer, int max_steps);

  /// See Recall::records().
  Result<std::vector<EngineRecord>> records(const MemoryId& entity, std::optional<Time> from,
                                            Duration ahead, Prefer prefer);

 private:
  /// What an entity's engines learned from its snapshots up to `last`.
  struct Learned {
    MemoryId entity;
    Prefer prefer = Prefer::kRecorded;
    Time last{};
    size_t wanted = 0;  ///< EngineChoice::snapshots_wanted().
    std::unique_ptr<EngineChoice> choice;
  };

  Result<Learned*> learned(const MemoryId& entity, std::optional<Time> from, Prefer prefer);
  Result<Learned> begun(const MemoryId& entity, const Snapshot& newest, Prefer prefer);
  Status add_new(Learned& learned, std::span<const SnapshotEntry> entries, Snapshot newest);
  Result<std::optional<idf::Data>> condition_at(const MemoryId& entity, Time time, Prefer prefer);
  Result<std::vector<SnapshotResult>> predict_by_choice(const MemoryId& entity,
                                                        const Outlook& outlook, Prefer prefer,
                                                        int max_steps);
  Result<std::vector<SnapshotResult>> read_all(const MemoryId& entity,
                                               std::span<const SnapshotEntry> entries,
                                               Prefer prefer);
  Result<std::vector<idf::Data>> conditions_of(const Predictor& predictor,
                                               std::span<const SnapshotEntry> entries,
                                               Prefer prefer);
  Result<std::vector<idf::Data>> plan_of(const Predictor& predictor, const MemoryId& entity,
                                         Time last, size_t steps, Prefer prefer);

  PastReader& past_;
  MakeEngineChoice make_choice_;
  std::optional<Learned> learned_;
  std::unique_ptr<Predictor> copy_last_ = make_copy_last_predictor();
};

}  // namespace engram::ltm
