// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/memory/sight.h"
#include "ltm/prediction/entity_predictor.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/answer.h"
#include "ltm/recall/list_moments.h"
#include "ltm/recall/recall_predictor.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// Answers queries: about the past from whichever form holds it, about the future by prediction. A
/// store that is opened offline and a server both answer through this class, so their answers
/// agree.
///
/// Threading: one thread.
/// Source: docs/query.md, section "Answers".
class Recall {
 public:
  struct AnswerCursor;
  using Prefer = ltm::Prefer;
  using Engine = ltm::Engine;
  using PredictionRequest = ltm::PredictionRequest;

  struct Options {
    Prefer prefer = Prefer::kRecorded;
    /// Max horizon of a prediction, counted from the last snapshot; it holds for all engines.
    Duration max_horizon = std::chrono::minutes(1);
    /// Name of the engine that predicts. Empty: the best engine for each horizon.
    std::string engine{};
    /// Max plain bytes that are decoded for one answer; a larger answer is an error. Values of
    /// working memory are shared and do not count.
    size_t max_answer_bytes = SIZE_MAX;
    /// What may be seen by who asks; null: everything. Predictions that may not be seen are left
    /// out of answers to queries.
    SharedView view{};
    /// Places and context of entities that this past does not have, for conditions that name them.
    std::shared_ptr<const OtherContexts> others{};
  };

  /// If `accesses` is given, it notes each past snapshot whose data an answer has and that was not
  /// held in working memory. `make_choice` makes what chooses among engines. If it is empty, the
  /// newest model predicts or, without a model, a copy of the last snapshot.
  explicit Recall(std::unique_ptr<KnownPast> past, std::unique_ptr<AccessLog> accesses = nullptr,
                  MakeEngineChoice make_choice = make_entity_predictor);

  /// Answers from a store alone. Without a `loader` latents cannot be decoded and no model
  /// predicts.
  Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
         std::unique_ptr<AccessLog> accesses = nullptr,
         MakeEngineChoice make_choice = make_entity_predictor);
  ~Recall();

  /// The store, if this answers from a store alone (checked). Valid until the next question.
  [[nodiscard]] StoreReader& store();

  /// Answers a query. If it asks for IDs only, nothing is decoded or predicted: the answer names
  /// the instances and their source, but no model.
  /// Errors: kNotFound if no entity matches; kInvalidArgument if a horizon is too far ahead;
  /// kFailedPrecondition if a latent needs a model and there is no loader; kResourceExhausted if
  /// the answer would be too large; kDataLoss.
  Result<Answer> answer(const Query& query, const Options& options);

  /// Begins an answer that comes in parts, so that nobody has to hold all of it.
  /// Errors: kNotFound if no entity matches.
  Result<AnswerCursor> begin(const Query& query, const Options& options);

  /// The next part, of about `bytes` of data: entities in order, the last of which may go on in the
  /// next part. `options.max_answer_bytes` does not count. Each part shows the store as it is then.
  /// Needs a cursor that is not done (checked).
  /// Errors: those of answer(). The cursor stays where it was.
  Result<Answer> next(AnswerCursor& cursor, size_t bytes);

  /// Returns the same answer as a tree.
  Result<QueryResult> query(const Query& query, const Options& options);
  Result<QueryResult> query(const Query& query) { return this->query(query, Options{}); }

  /// What answers the conditions of a query on an entity, for who selects snapshots of the store by
  /// himself. `is_named`: the query names the entity letter by letter. Valid as long as this
  /// object.
  [[nodiscard]] ListMoments listed(const MemoryId& entity, bool is_named);

  /// The context of an entity as a view sees it, for who asks another memory. Null if there is no
  /// such entity, or if nothing of it is seen. Errors: those of query().
  Result<SharedContext> context(const MemoryId& entity, const SharedView& view);

  /// Drops everything that was read or learned for earlier questions: decoded snapshots, models,
  /// and what engines learned. Call it after something was forgotten, so that no answer tells of
  /// it. Errors: those of reading the store. Nothing of what was dropped comes back then either.
  Status start_anew();

  /// The predictors of an entity: that of its newest model, if it has one, and a copy of the last
  /// snapshot, with measured errors if the model file has them. They live as long as this object,
  /// or until start_anew().
  /// Errors: kNotFound if there is no such entity.
  Result<std::vector<Engine>> engines(const MemoryId& entity);

  /// The engine whose predictor has this name; with an empty name the first one.
  /// Errors: kNotFound.
  Result<Engine> engine(const MemoryId& entity, const std::string& name);

  /// All engines that can predict an entity from the moment `from` on (empty: its newest moment),
  /// with their errors at the horizon `ahead`, measured on the past before that moment. The engine
  /// that would answer comes first.
  /// Errors: those of predict().
  Result<std::vector<EngineRecord>> records(const MemoryId& entity, std::optional<Time> from,
                                            Duration ahead, const Options& options);

  /// Returns one prediction per horizon, in their order. `request.engine` names the engine;
  /// `options.engine` is ignored. If the plan has no snapshot after that moment, the prediction is
  /// made without it and names no plan. Also kFailedPrecondition if the view may not see
  /// predictions of the entity, or not all of the plan or of another entity that a model starts
  /// from. Errors: kNotFound if there is no such entity, engine, or snapshot at or before `from`;
  /// kInvalidArgument if a horizon is too far ahead, if a plan is given to an engine that has no
  /// condition, or if the plan has another layout; those of query().
  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity,
                                              const PredictionRequest& request,
                                              const Options& options);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Where an answer in parts goes on.
struct Recall::AnswerCursor {
  struct Position {
    size_t entity = 0;  ///< The index of the next entity.
    /// What is selected of it, and the last moment that was answered, once it was begun.
    std::optional<SelectedMoments> selected{};
    std::optional<Time> last{};
  };

  Query query;
  Options options;
  std::vector<MemoryId> entities;  ///< All that match.
  Position position{};

  [[nodiscard]] bool is_done() const { return position.entity == entities.size(); }
};

}  // namespace engram::ltm
