// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ltm/prediction/engine_choice.h"
#include "ltm/recall/known_past.h"

namespace engram::ltm {

/// What is to be predicted, and from when on.
struct PredictionRequest {
  /// The last moment that is known: later snapshots are not looked at. Nothing: the newest one.
  std::optional<Time> from;
  /// From the last snapshot that is known on. At least one, each more than zero; models take each
  /// as the closest number of their steps, at least one.
  std::vector<Duration> horizons;
  std::string engine;  ///< By its name; empty: the best for each horizon, see records().
  /// Entity whose snapshots after the last known moment are planned values of the engine's
  /// condition (Predictor::condition), of its layout. The condition itself: what really came of
  /// it, in hindsight. Nothing: no plan is told.
  std::optional<MemoryId> plan{};
};

/// Predicts entities from their past, by whichever engine was best on it.
///
/// What engines learned is kept for the entities that were asked about last; of these only what
/// came since is read. Older snapshots that cannot be read are left out, and a condition that
/// cannot be read is not known: a prediction needs the newest snapshot alone.
/// Threading: one thread.
/// Source: docs/prediction.md.
class RecallPredictor {
 public:
  struct Options {
    Prefer prefer = Prefer::kRecorded;  ///< What the past is read from.
    /// A prediction reaches at most so far. Engines are measured on horizons of seconds; a model
    /// needs time for each of its steps.
    Duration max_horizon = std::chrono::minutes(1);
  };

  /// `past` outlives it. Without `make_choice` there are no engines but those of engines(), and the
  /// first of them answers; so it does where a plan is told.
  RecallPredictor(KnownPast& past, MakeEngineChoice make_choice)
      : past_(past), make_choice_(std::move(make_choice)) {}

  /// See Recall::engines().
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// See Recall::engine().
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// See Recall::predict().
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity,
                                              const PredictionRequest& request,
                                              const Options& options);

  /// See Recall::records().
  Result<std::vector<EngineRecord>> records(const MemoryId& entity, std::optional<Time> from,
                                            Duration ahead, const Options& options);

 private:
  /// What an entity's engines learned from its snapshots up to `last`.
  struct Learned {
    MemoryId entity;
    Prefer prefer = Prefer::kRecorded;
    std::vector<std::string> models;  ///< That it predicts by.
    Time last{};
    size_t wanted = 0;  ///< EngineChoice::snapshots_wanted().
    std::unique_ptr<EngineChoice> choice;
  };

  /// Of these entities it is kept: images that engines learn from are not small.
  static constexpr size_t kMaxLearned = 64;

  Result<std::unique_ptr<EntityPast>> known(const MemoryId& entity);
  Result<Learned*> learned(const MemoryId& entity, std::optional<Time> from, Prefer prefer);
  Status update(Learned& learned, EntityPast& past, Time last);
  Result<Learned> begun(const MemoryId& entity, const Snapshot& newest, Prefer prefer);
  Status add_new(Learned& learned, EntityPast& past, std::span<const Time> moments,
                 Snapshot newest);
  Result<std::vector<std::string>> models_of(const MemoryId& entity);
  Result<std::optional<idf::Data>> condition_at(const MemoryId& entity, Time time, Prefer prefer);
  Result<std::vector<SnapshotResult>> predict_planned(const MemoryId& entity,
                                                      const PredictionRequest& request,
                                                      const Options& options);
  Result<std::vector<idf::Data>> conditions_of(const Predictor& predictor,
                                               std::span<const SnapshotResult> history,
                                               Prefer prefer);
  Result<std::vector<idf::Data>> plan_of(const Predictor& predictor, const MemoryId& entity,
                                         Time last, size_t steps, Prefer prefer);

  KnownPast& past_;
  MakeEngineChoice make_choice_;
  std::list<Learned> learned_;  ///< The one that was asked about last in front.
  /// Of entities that conditions are of; for one call alone.
  std::map<MemoryId, std::unique_ptr<EntityPast>> conditions_;
  std::unique_ptr<Predictor> copy_last_ = make_copy_last_predictor();
};

}  // namespace engram::ltm
