// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// Answers queries from a store: about the past from whatever form holds it, about the future by
/// prediction.
///
/// Threading: one thread.
class Recall {
 public:
  /// Which form answers where a snapshot has both.
  enum class Prefer { kRecorded, kLatent };

  struct Options {
    Prefer prefer = Prefer::kRecorded;
    /// Longest prediction, in steps of the predictor.
    int max_steps = 50;
  };

  /// Without a `loader` latents cannot be decoded and predictions are copies of the last snapshot.
  /// With `accesses` every snapshot of the past whose data is in an answer is noted as read.
  Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
         std::unique_ptr<AccessLog> accesses = nullptr);
  ~Recall();

  [[nodiscard]] StoreReader& store();

  /// Where only IDs are asked for nothing is decoded or predicted: the answer names instances, and
  /// the source that would answer, but no model.
  /// Errors: kNotFound where no entity matches; kInvalidArgument where a prediction is asked too
  /// far ahead; kFailedPrecondition where a latent needs a model and there is no loader; kDataLoss.
  Result<QueryResult> query(const Query& query, const Options& options);
  Result<QueryResult> query(const Query& query) { return this->query(query, Options{}); }

  /// A way to predict an entity.
  struct Engine {
    Predictor* predictor = nullptr;  ///< Never null; this owns it.
    std::string model;               ///< "Vision/RGB/head/cam v1"; empty without one.
  };

  /// What can predict an entity, what a query would take first: its newest model, if it has one,
  /// and a copy of the last snapshot.
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// The one whose predictor has this name; empty: the first.
  /// Errors: kNotFound.
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

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

  /// One prediction per horizon, in their order.
  /// Errors: kNotFound where there is no such entity, engine, or snapshot at or before `from`;
  /// kInvalidArgument where a horizon is too far ahead, where a plan is told to an engine that
  /// starts from no other entity, or has another layout; those of query(). Where nothing is planned
  /// after that moment the prediction is made without, and names no plan.
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity, const Outlook& outlook,
                                              const Options& options);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
