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

/// What to predict, and from which moment on.
struct PredictionRequest {
  /// Snapshots after this moment are not used. Empty: all snapshots are used.
  std::optional<Time> from;
  /// Horizons, counted from the last snapshot that is used. At least one, each positive. Models
  /// round each to the closest number of their steps, at least one.
  std::vector<Duration> horizons;
  std::string engine;  ///< Its name; empty: the best for each horizon, see records().
  /// Entity whose snapshots after the last known moment are the planned values of the engine's
  /// condition (Predictor::condition). It has the condition's layout. It may be the condition
  /// itself: then the plan is what really happened, in hindsight. Empty: no plan.
  std::optional<MemoryId> plan{};
  /// Lets engines go on from the moment that was asked before, if that is earlier, and learn what
  /// came since. Many moments in their order are predicted faster so, but errors and choices then
  /// depend a little on which moments were asked. Without `from` engines always go on.
  bool learns_on = false;

  /// Whether engines go on.
  [[nodiscard]] bool goes_on() const { return learns_on || !from; }
};

/// Predicts entities from their past, with the engine that was best on it.
///
/// It keeps what the engines learned for the entities that were asked about most recently, and
/// reads only their newer snapshots. A question from an earlier moment starts anew, so that its
/// answer does not depend on what was asked before, and changes nothing for later questions. A
/// prediction needs only the newest snapshot: older ones that cannot be read are left out, and a
/// condition that cannot be read counts as unknown. Threading: one thread. Source:
/// docs/prediction.md.
class RecallPredictor {
 public:
  struct Options {
    Prefer prefer = Prefer::kRecorded;  ///< The form that the past is read from.
    /// Max horizon of a prediction. Engines are measured on horizons of seconds, and a model needs
    /// time for each of its steps.
    Duration max_horizon = std::chrono::minutes(1);
  };

  /// `past` must outlive it. Without `make_choice` only the engines of engines() exist, and the
  /// first of them answers. A request with a plan uses only these engines too.
  RecallPredictor(KnownPast& past, MakeEngineChoice make_choice)
      : past_(past), make_choice_(std::move(make_choice)) {}

  /// Drops what engines learned.
  void start_anew() { learned_.clear(); }

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
    bool goes_on = false;             ///< PredictionRequest::goes_on().
    std::vector<std::string> models;  ///< Names of the models among the engines.
    Time last{};
    size_t wanted = 0;  ///< EngineChoice::snapshots_wanted().
    std::unique_ptr<EngineChoice> choice;
  };

  /// Max entities whose engines are kept. The images that engines learn from take much memory.
  static constexpr size_t kMaxLearned = 64;

  Result<std::unique_ptr<EntityPast>> known(const MemoryId& entity);
  Result<Learned*> learned(const MemoryId& entity, std::optional<Time> from, Prefer prefer,
                           bool goes_on);
  Status update(Learned& learned, EntityPast& past, Time last);
  Result<Learned> begun(const Learned& learned, const Snapshot& newest);
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
  std::list<Learned> learned_;  ///< The most recently used one in front.
  uint64_t era_ = 0;            ///< KnownPast::era() when they learned.
  /// Pasts of the entities that are conditions; kept during one call only.
  std::map<MemoryId, std::unique_ptr<EntityPast>> conditions_;
  std::unique_ptr<Predictor> copy_last_ = make_copy_last_predictor();
};

}  // namespace engram::ltm
