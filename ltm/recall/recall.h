// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/memory/query.h"
#include "ltm/prediction/entity_predictor.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/answer.h"
#include "ltm/recall/recall_predictor.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// Answers what was and what will be: about the past from whatever form holds it, about the future
/// by prediction. A store that is opened offline and a server answer through this alone, so they
/// say the same.
///
/// Threading: one thread.
/// Source: docs/query.md, section "Answers".
class Recall {
 public:
  using Prefer = ltm::Prefer;
  using Engine = ltm::Engine;
  using PredictionRequest = ltm::PredictionRequest;

  struct Options {
    Prefer prefer = Prefer::kRecorded;
    /// Predictions reach at most so far after the last snapshot, whatever predicts.
    Duration max_horizon = std::chrono::minutes(1);
    std::string engine{};  ///< Of predictions, by its name; empty: the best for each horizon.
    /// What may be decoded for one answer. Unit: plain bytes. Who asks a server for more is told
    /// to ask for less; values of working memory are shared, and do not count.
    size_t max_answer_bytes = SIZE_MAX;
  };

  /// With `accesses` every snapshot of the past whose data is in an answer, and that was not held
  /// in working memory, is noted as read. `make_choice`: what chooses among engines; empty: the
  /// newest model predicts, or where there is none, a copy of the last snapshot.
  explicit Recall(std::unique_ptr<KnownPast> past, std::unique_ptr<AccessLog> accesses = nullptr,
                  MakeEngineChoice make_choice = make_entity_predictor);

  /// Of a store alone. Without a `loader` latents cannot be decoded and no model predicts.
  Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
         std::unique_ptr<AccessLog> accesses = nullptr,
         MakeEngineChoice make_choice = make_entity_predictor);
  ~Recall();

  /// The store that this answers from alone (checked), as it is until the next question.
  [[nodiscard]] StoreReader& store();

  /// Where only IDs are asked for nothing is decoded or predicted: the answer names instances, and
  /// the source that would answer, but no model.
  /// Errors: kNotFound where no entity matches; kInvalidArgument where a prediction is asked too
  /// far ahead; kFailedPrecondition where a latent needs a model and there is no loader;
  /// kResourceExhausted where the answer would be too large; kDataLoss.
  Result<Answer> answer(const Query& query, const Options& options);

  /// The same as a tree.
  Result<QueryResult> query(const Query& query, const Options& options);
  Result<QueryResult> query(const Query& query) { return this->query(query, Options{}); }

  /// What of models can predict an entity: the newest one, if it has one, and a copy of the last
  /// snapshot, which knows how wrong that was. They live as long as this.
  /// Errors: kNotFound where there is no such entity.
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// The one whose predictor has this name; empty: the first.
  /// Errors: kNotFound.
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// Everything that can predict an entity from a moment on (nothing: the newest), and what it was
  /// worth so far ahead on the past before it; what answers comes first.
  /// Errors: those of predict().
  Result<std::vector<EngineRecord>> records(const MemoryId& entity, std::optional<Time> from,
                                            Duration ahead, const Options& options);

  /// One prediction per horizon, in their order. `options.engine` is not looked at: `request` says.
  /// Errors: kNotFound where there is no such entity, engine, or snapshot at or before `from`;
  /// kInvalidArgument where a horizon is too far ahead, where a plan is told to an engine that
  /// starts from no other entity, or has another layout; those of query(). Where nothing is planned
  /// after that moment the prediction is made without, and names no plan.
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity,
                                              const PredictionRequest& request,
                                              const Options& options);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
