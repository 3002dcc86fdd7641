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

  /// What can predict an entity, what a query would take first: its newest model, if it has one,
  /// and a copy of the last snapshot. This owns the predictors.
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// The one whose predictor has this name; empty: the first.
  /// Errors: kNotFound.
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

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
