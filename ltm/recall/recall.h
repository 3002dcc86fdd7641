// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/memory/query.h"
#include "ltm/memory/result.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/forecaster.h"

namespace engram::ltm {

/// Answers queries from a store: about the past from whatever form holds it, about the future by
/// prediction.
///
/// Threading: one thread.
class Recall {
 public:
  using Prefer = ltm::Prefer;
  using Engine = ltm::Engine;
  using Outlook = ltm::Outlook;

  struct Options {
    Prefer prefer = Prefer::kRecorded;
    /// Longest prediction, in steps of the predictor.
    int max_steps = 50;
  };

  /// Without a `loader` latents cannot be decoded and no model predicts. With `accesses` every
  /// snapshot of the past whose data is in an answer is noted as read. Without `make_choice` the
  /// newest model predicts; where there is none, predictions are copies of the last snapshot.
  Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
         std::unique_ptr<AccessLog> accesses = nullptr, MakeEngineChoice make_choice = {});
  ~Recall();

  [[nodiscard]] StoreReader& store();

  /// Where only IDs are asked for nothing is decoded or predicted: the answer names instances, and
  /// the source that would answer, but no model.
  /// Errors: kNotFound where no entity matches; kInvalidArgument where a prediction is asked too
  /// far ahead; kFailedPrecondition where a latent needs a model and there is no loader; kDataLoss.
  Result<QueryResult> query(const Query& query, const Options& options);
  Result<QueryResult> query(const Query& query) { return this->query(query, Options{}); }

  /// What of models can predict an entity: the newest one, if it has one, and a copy of the last
  /// snapshot, which knows how wrong that was. This owns the predictors.
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// The one whose predictor has this name; empty: the first.
  /// Errors: kNotFound.
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// Everything that can predict an entity from a moment on (nothing: the newest), and what it was
  /// worth so far ahead on the past before it; what answers comes first.
  /// Errors: those of predict().
  Result<std::vector<EngineRecord>> records(const MemoryId& entity, std::optional<Time> from,
                                            Duration ahead, const Options& options);

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
