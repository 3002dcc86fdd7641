// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall.h"

#include <algorithm>

#include "ltm/idf/binary.h"
#include "ltm/recall/seen_past.h"

namespace engram::ltm {

namespace {

/// Max entities that a message lists.
constexpr size_t kMaxNamed = 20;

/// An estimate of what a moment costs beside its values. Unit: bytes.
constexpr size_t kMomentBytes = 256;

size_t bytes_of(const SnapshotResult& snapshot) {
  size_t bytes = kMomentBytes;
  for (const InstanceResult& instance : snapshot.instances)
    bytes += idf::encoded_size(instance.data);
  return bytes;
}

/// Removes the instances that were not selected. False if none of the selected ones exists.
bool keep_selected(SnapshotResult& snapshot, const std::vector<int32_t>& instances) {
  if (!instances.empty())
    std::erase_if(snapshot.instances, [&instances](const InstanceResult& instance) {
      return !std::ranges::binary_search(instances, instance.index);
    });
  return instances.empty() || !snapshot.instances.empty();
}

/// Asks again, of the newest state of the store, if a consolidation or a sealing changed the store
/// during the first attempt.
template <typename Ask>
auto retried(KnownPast& past, const Ask& ask) -> decltype(ask()) {
  auto first = ask();
  if (first.ok() || first.status().code() != StatusCode::kUnavailable) return first;
  ENGRAM_RETURN_IF_ERROR(past.renew());
  return ask();
}

/// Of an answer of many parts only the first one is kept decoded.
class KeepDecoded {
 public:
  KeepDecoded(KnownPast& past, bool keeps) : past_(past) { past_.keep_decoded(keeps); }
  ~KeepDecoded() { past_.keep_decoded(true); }
  KeepDecoded(const KeepDecoded&) = delete;
  KeepDecoded& operator=(const KeepDecoded&) = delete;

 private:
  KnownPast& past_;
};

}  // namespace

struct Recall::State {
  std::unique_ptr<KnownPast> past;
  StorePast* store = nullptr;  ///< The past, if it is that of a store alone.
  RecallPredictor predictor;
  std::unique_ptr<AccessLog> accesses;  ///< May be null.

  State(std::unique_ptr<KnownPast> known, std::unique_ptr<AccessLog> notes,
        MakeEngineChoice make_choice)
      : past(std::move(known)),
        predictor(*past, std::move(make_choice)),
        accesses(std::move(notes)) {}

  /// The past of an entity, as the view sees it; null if it sees none.
  Result<std::unique_ptr<EntityPast>> seen(const MemoryId& entity, const Options& options) const {
    if (!options.view) return past->of(entity);
    const Sight sight = options.view->of(entity);
    if (sight.times.empty()) return std::unique_ptr<EntityPast>();
    ENGRAM_ASSIGN_OR_RETURN(auto all, past->of(entity));
    return seen_past(std::move(all), sight.times);
  }

  /// Whether the view sees any snapshot of an entity that has some. One that cannot be read is
  /// told of by who reads it.
  [[nodiscard]] bool sees_any(const MemoryId& entity, const Options& options) const {
    const TimeWindows times = sight_of(options.view.get(), entity).times;
    if (times.empty() || times.is_all()) return !times.empty();
    const auto found = seen(entity, options);
    return !found.ok() || *found != nullptr;
  }

  /// The entities that match, without those of which the view sees nothing at any time. Whether it
  /// sees any of the others takes a look at each: that is left to who answers, but for a view that
  /// sees nothing of all of them, which gets none.
  [[nodiscard]] std::vector<MemoryId> matching(const Query& query, const Options& options) const {
    std::vector<MemoryId> entities = past->matching(query);
    if (!options.view) return entities;
    std::erase_if(entities,
                  [&](const MemoryId& entity) { return options.view->of(entity).times.empty(); });
    if (std::ranges::none_of(entities,
                             [&](const MemoryId& entity) { return sees_any(entity, options); }))
      entities.clear();
    return entities;
  }

  /// Whether the view may see predictions of an entity, which also tell of the entities that its
  /// models start from. The error names none of these.
  Status check_predicts(const MemoryId& entity, const Options& options) {
    if (!options.view) return {};
    if (!options.view->of(entity).predictions)
      return failed_precondition("'{}': its predictions may not be seen", entity.to_string());
    ENGRAM_ASSIGN_OR_RETURN(const auto models, past->models(entity));
    for (const Engine& model : models)
      if (const auto condition = model.predictor->condition();
          condition && !options.view->of(*condition).is_all())
        return failed_precondition(
            "'{}': its predictions tell of another entity, which may not be seen",
            entity.to_string());
    return {};
  }

  /// Adds future moments without their data. They have the instances of the last snapshot.
  Status name_future(EntityPast& entity, std::span<const SelectedSnapshot> future,
                     const Options& options, RecalledEntity& result) const {
    ENGRAM_ASSIGN_OR_RETURN(const auto last, entity.last());
    if (!last) return {};
    ENGRAM_ASSIGN_OR_RETURN(const RecalledSnapshot known, entity.name(*last, options.prefer));
    for (const SelectedSnapshot& selected : future) {
      SnapshotResult named = known.answer;
      named.time = selected.time;
      named.source = Source::kPredicted;
      named.horizon = selected.time - *last;
      if (keep_selected(named, selected.instances)) result.snapshots.push_back({std::move(named)});
    }
    return {};
  }

  /// Predicts all moments in one call: a model passes the nearer ones on its way to the farthest.
  Status predict_future(EntityPast& entity, std::span<const SelectedSnapshot> future,
                        const Options& options, RecalledEntity& result) {
    ENGRAM_ASSIGN_OR_RETURN(const auto last, entity.last());
    if (!last) return {};
    PredictionRequest request{*last, {}, options.engine};
    request.learns_on = true;
    for (const SelectedSnapshot& selected : future)
      request.horizons.push_back(selected.time - *last);
    ENGRAM_ASSIGN_OR_RETURN(
        auto predicted,
        predictor.predict(result.id, request, {options.prefer, options.max_horizon}));
    for (size_t i = 0; i < future.size(); ++i) {
      predicted[i].time = future[i].time;
      if (keep_selected(predicted[i], future[i].instances))
        result.snapshots.push_back({std::move(predicted[i])});
    }
    return {};
  }

  Status add_past(EntityPast& entity, const SelectedSnapshot& selected, const Query& query,
                  const Options& options, size_t& bytes, RecalledEntity& result) const {
    ENGRAM_ASSIGN_OR_RETURN(RecalledSnapshot snapshot,
                            query.is_ids_only() ? entity.name(selected.time, options.prefer)
                                                : entity.read(selected.time, options.prefer));
    if (!keep_selected(snapshot.answer, selected.instances)) return {};
    if (!snapshot.held) bytes += bytes_of(snapshot.answer);
    if (bytes > options.max_answer_bytes)
      return resource_exhausted(
          "'{}' asks for more than the {} bytes that an answer may have: needs fewer moments than "
          "those of '{}', or IDs alone",
          query.to_string(), options.max_answer_bytes, result.id.to_string());
    result.snapshots.push_back(std::move(snapshot));
    return {};
  }

  /// What answers the conditions of a query on an entity; nothing if it has none.
  ListMoments listed(const MemoryId& id, EntityPast& own, const Query& query,
                     const Options& options) const {
    if (!query.has_conditions()) return {};
    return list_moments(
        *past, [this, options](const MemoryId& entity) { return seen(entity, options); }, id, own,
        query.named_entities().has_value(), options.others);
  }

  /// Nothing if the view sees nothing of the entity.
  Result<std::optional<RecalledEntity>> answer(const MemoryId& id, const Query& query,
                                               const Options& options, size_t& bytes) {
    RecalledEntity result{id, {}};
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, seen(id, options));
    if (!entity) return options.view ? std::nullopt : std::optional(std::move(result));
    ENGRAM_ASSIGN_OR_RETURN(
        const auto selection,
        select_snapshots(query.snapshots_of(id), *entity, listed(id, *entity, query, options)));
    const auto future = std::ranges::find(selection, true, &SelectedSnapshot::is_future);
    for (auto selected = selection.begin(); selected != future; ++selected)
      ENGRAM_RETURN_IF_ERROR(add_past(*entity, *selected, query, options, bytes, result));
    ENGRAM_RETURN_IF_ERROR(add_future(*entity, {future, selection.end()}, query, options, result));
    return std::optional(std::move(result));
  }

  /// Adds what follows of the entity at `position` until the part has `max_bytes`, and counts them.
  /// Returns the position behind it. `is_seen` becomes false if the view sees nothing of it.
  Result<AnswerCursor::Position> add_next(const AnswerCursor& cursor,
                                          AnswerCursor::Position position, size_t max_bytes,
                                          size_t& bytes, RecalledEntity& result, bool& is_seen) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, seen(result.id, cursor.options));
    is_seen = entity != nullptr || !cursor.options.view;
    if (entity && !position.selected) {
      ENGRAM_ASSIGN_OR_RETURN(
          position.selected,
          SelectedMoments::create(cursor.query.snapshots_of(result.id), *entity,
                                  listed(result.id, *entity, cursor.query, cursor.options)));
    }
    Options options = cursor.options;
    options.max_answer_bytes = SIZE_MAX;
    while (entity) {
      if (bytes >= max_bytes) return position;
      ENGRAM_ASSIGN_OR_RETURN(const auto next, position.selected->after(position.last, *entity));
      if (!next) break;
      size_t decoded = 0;
      const size_t count = result.snapshots.size();
      ENGRAM_RETURN_IF_ERROR(add_past(*entity, *next, cursor.query, options, decoded, result));
      position.last = next->time;
      if (result.snapshots.size() == count) continue;
      const SharedSnapshot& held = result.snapshots.back().held;
      bytes += held && !cursor.query.is_ids_only() ? kMomentBytes + held->plain_bytes() : decoded;
    }
    if (entity)
      ENGRAM_RETURN_IF_ERROR(
          add_future(*entity, position.selected->future(), cursor.query, options, result));
    bytes += kMomentBytes;  // An entity without moments is in the answer, too.
    return AnswerCursor::Position{position.entity + 1};
  }

  Status add_future(EntityPast& entity, std::span<const SelectedSnapshot> future,
                    const Query& query, const Options& options, RecalledEntity& result) {
    if (future.empty()) return {};
    if (const Status seen = check_predicts(result.id, options); !seen.ok())
      return seen.code() == StatusCode::kFailedPrecondition ? Status() : seen;
    return query.is_ids_only() ? name_future(entity, future, options, result)
                               : predict_future(entity, future, options, result);
  }

  void note_reads(const RecalledEntity& entity) const {
    for (const RecalledSnapshot& snapshot : entity.snapshots)
      if (!snapshot.held && snapshot.answer.source != Source::kPredicted)
        accesses->note(entity.id, snapshot.answer.time);
  }

  [[nodiscard]] Status no_match(const Query& query, const Options& options) const {
    std::string names;
    size_t named = 0;
    const auto every_entity = Query::parse(".*");
    if (every_entity.ok()) {
      const std::vector<MemoryId> entities = past->matching(*every_entity);
      for (const MemoryId& entity : entities) {
        if (named == kMaxNamed) break;
        if (!sees_any(entity, options)) continue;
        names += (named == 0 ? "" : ", ") + entity.to_string();
        ++named;
      }
      // How many more may be seen would take a look at all of them.
      if (named == kMaxNamed && entities.size() > named)
        names += options.view ? " and maybe more"
                              : " and " + std::to_string(entities.size() - named) + " more";
    }
    return not_found("{}: no entity matches '{}'; it has: {}", past->name(), query.to_string(),
                     names.empty() ? "none" : names);
  }
};

Recall::Recall(std::unique_ptr<KnownPast> past, std::unique_ptr<AccessLog> accesses,
               MakeEngineChoice make_choice)
    : state_(
          std::make_unique<State>(std::move(past), std::move(accesses), std::move(make_choice))) {}

Recall::Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
               std::unique_ptr<AccessLog> accesses, MakeEngineChoice make_choice) {
  auto past = std::make_unique<StorePast>(std::move(store), std::move(loader));
  StorePast* const known = past.get();
  state_ = std::make_unique<State>(std::move(past), std::move(accesses), std::move(make_choice));
  state_->store = known;
}

Recall::~Recall() = default;

StoreReader& Recall::store() {
  ENGRAM_CHECK(state_->store != nullptr, "{} is more than a store", state_->past->name());
  return state_->store->store();
}

Result<SharedContext> Recall::context(const MemoryId& entity, const SharedView& view) {
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  Options options;
  options.view = view;
  return retried(*state_->past, [&] {
    return context_for_others(
        *state_->past, [&](const MemoryId& id) { return state_->seen(id, options); }, entity);
  });
}

ListMoments Recall::listed(const MemoryId& entity, bool is_named) {
  return list_moments(*state_->past, entity, is_named);
}

Status Recall::start_anew() {
  // First the predictor, which points to models of the past.
  state_->predictor.start_anew();
  return state_->past->start_anew();
}

Result<std::vector<Engine>> Recall::engines(const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  ENGRAM_ASSIGN_OR_RETURN(const auto past, state_->past->of(entity));
  if (!past) return not_found("{}: has no entity '{}'", state_->past->name(), entity.to_string());
  return state_->predictor.engines(entity);
}

Result<Engine> Recall::engine(const MemoryId& entity, const std::string& name) {
  ENGRAM_RETURN_IF_ERROR(engines(entity).status());
  return state_->predictor.engine(entity, name);
}

Result<std::vector<EngineRecord>> Recall::records(const MemoryId& entity, std::optional<Time> from,
                                                  Duration ahead, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  return retried(*state_->past, [&]() -> Result<std::vector<EngineRecord>> {
    ENGRAM_RETURN_IF_ERROR(state_->check_predicts(entity, options));
    return state_->predictor.records(entity, from, ahead, {options.prefer, options.max_horizon});
  });
}

Result<std::vector<SnapshotResult>> Recall::predict(const MemoryId& entity,
                                                    const PredictionRequest& request,
                                                    const Options& options) {
  if (request.horizons.empty())
    return invalid_argument("entity '{}': found no horizon to predict, needs one",
                            entity.to_string());
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  if (request.plan && !sight_of(options.view.get(), *request.plan).is_whole())
    return failed_precondition("'{}': not all of this plan may be seen", request.plan->to_string());
  return retried(*state_->past, [&]() -> Result<std::vector<SnapshotResult>> {
    ENGRAM_RETURN_IF_ERROR(state_->check_predicts(entity, options));
    return state_->predictor.predict(entity, request, {options.prefer, options.max_horizon});
  });
}

Result<Answer> Recall::answer(const Query& query, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  const std::vector<MemoryId> entities = state_->matching(query, options);
  if (entities.empty()) return state_->no_match(query, options);
  Answer answer{query.is_ids_only(), {}};
  size_t bytes = 0;
  for (const MemoryId& entity : entities) {
    // A failed attempt may have counted bytes: a retry starts from the count before it.
    ENGRAM_ASSIGN_OR_RETURN(std::optional<RecalledEntity> one,
                            retried(*state_->past, [&, before = bytes] {
                              bytes = before;
                              return state_->answer(entity, query, options, bytes);
                            }));
    if (!one) continue;
    if (state_->accesses && !query.is_ids_only()) state_->note_reads(*one);
    answer.entities.push_back(*std::move(one));
  }
  return answer;
}

Result<Recall::AnswerCursor> Recall::begin(const Query& query, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  AnswerCursor cursor{query, options, state_->matching(query, options)};
  if (cursor.entities.empty()) return state_->no_match(query, options);
  return cursor;
}

Result<Answer> Recall::next(AnswerCursor& cursor, size_t bytes) {
  ENGRAM_CHECK(!cursor.is_done(), "'{}' is answered", cursor.query.to_string());
  ENGRAM_RETURN_IF_ERROR(state_->past->follow());
  Answer part{cursor.query.is_ids_only(), {}};
  AnswerCursor::Position position = cursor.position;
  const KeepDecoded keep(*state_->past, position.entity == 0 && !position.selected);
  for (size_t filled = 0; position.entity < cursor.entities.size() && filled < bytes;) {
    RecalledEntity one{cursor.entities[position.entity], {}};
    size_t counted = filled;
    bool is_seen = true;
    ENGRAM_ASSIGN_OR_RETURN(position, retried(*state_->past, [&] {
                              // A failed attempt has no effect.
                              one.snapshots.clear();
                              counted = filled;
                              return state_->add_next(cursor, position, bytes, counted, one,
                                                      is_seen);
                            }));
    filled = counted;
    if (!is_seen) continue;
    if (state_->accesses && !part.is_ids_only) state_->note_reads(one);
    part.entities.push_back(std::move(one));
  }
  cursor.position = std::move(position);
  return part;
}

Result<QueryResult> Recall::query(const Query& query, const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(Answer answer, this->answer(query, options));
  return std::move(answer).to_result();
}

}  // namespace engram::ltm
