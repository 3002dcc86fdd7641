// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall_predictor.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "ltm/prediction/entity_predictor.h"

namespace engram::ltm {

namespace {

/// What a predictor is given in addition to the past of the entity, as in Past.
struct ToldValues {
  std::span<const idf::Data> conditions, plan;
};

/// The values of one instance in consecutive snapshots.
std::vector<idf::Data> series(const std::vector<SnapshotResult>& history, size_t instance) {
  std::vector<idf::Data> values;
  for (const SnapshotResult& past : history)
    if (instance < past.instances.size()) values.push_back(past.instances[instance].data);
  return values;
}

/// The last moments up to `time` and after `after`, at most `count` of them, sorted by time.
Result<std::vector<Time>> latest(EntityPast& past, std::optional<Time> time, size_t count,
                                 std::optional<Time> after = {}) {
  std::vector<Time> moments;
  while (time && moments.size() < count) {
    ENGRAM_ASSIGN_OR_RETURN(const auto moment, past.at_or_before(*time));
    if (!moment || (after && *moment <= *after)) break;
    moments.push_back(*moment);
    time = to_ns(*moment) == INT64_MIN ? std::nullopt
                                       : std::optional(time_from_ns(to_ns(*moment) - 1));
  }
  std::ranges::reverse(moments);
  return moments;
}

/// The last moment that is not after `from`; the last of all if `from` is empty.
Result<std::optional<Time>> last_known(EntityPast& past, std::optional<Time> from) {
  return from ? past.at_or_before(*from) : past.last();
}

Status check_horizons(const MemoryId& entity, const PredictionRequest& request, Time last,
                      Duration max) {
  for (const Duration ahead : request.horizons) {
    if (ahead <= Duration(0) || ahead.count() > INT64_MAX - std::max<int64_t>(0, to_ns(last)))
      return invalid_argument("entity '{}': found a horizon of {}, needs a moment after {}",
                              entity.to_string(), to_string(ahead), to_string(last));
    if (ahead > max)
      return invalid_argument("entity '{}': found a prediction {} ahead of {}, needs at most {}",
                              entity.to_string(), to_string(ahead), to_string(last),
                              to_string(max));
  }
  return {};
}

/// The number of steps that is closest to the horizon, at least one.
size_t steps_to(const Predictor& predictor, Duration horizon) {
  if (predictor.step() <= Duration(0)) return 1;
  return static_cast<size_t>(
      std::max(1.0, std::round(to_seconds(horizon) / to_seconds(predictor.step()))));
}

Status has_none_before(const MemoryId& entity, std::optional<Time> from) {
  return not_found("entity '{}': has no snapshot at or before {}", entity.to_string(),
                   from ? to_string(*from) : "now");
}

/// True if a snapshot cannot be read, now or later. A prediction leaves such snapshots out.
bool is_unreadable(const Status& status) {
  return status.code() == StatusCode::kDataLoss || status.code() == StatusCode::kFailedPrecondition;
}

Result<SnapshotResult> read(EntityPast& past, Time moment, Prefer prefer) {
  ENGRAM_ASSIGN_OR_RETURN(RecalledSnapshot recalled, past.read(moment, prefer));
  return std::move(recalled.answer);
}

/// Clears `pasts` at the end of a call, because they hold snapshots that working memory would free.
struct Cleared {
  std::map<MemoryId, std::unique_ptr<EntityPast>>& pasts;
  ~Cleared() { pasts.clear(); }
};

/// Adds one instance to each of `predicted`; `steps` says how many steps ahead each of them is.
/// `choice` tells the members of what was predicted; without it none are told.
Status predict_instance(const MemoryId& entity, const Engine& engine,
                        const std::vector<SnapshotResult>& history, size_t instance,
                        const ToldValues& told, std::span<const size_t> steps, EngineChoice* choice,
                        std::vector<SnapshotResult>& predicted) {
  const std::vector<idf::Data> values_before = series(history, instance);
  Past past{values_before};
  if (told.conditions.size() == values_before.size()) {
    past.conditions = told.conditions;
    past.plan = told.plan;
  }
  const size_t max = std::ranges::max(steps);
  auto values = engine.predictor->predict(past, static_cast<int>(max));
  if (!values.ok()) return values.status().with_context("prediction of " + entity.to_string());
  if (values->size() < max)
    return data_loss("model {}: predicted {} steps, needs {}", engine.model, values->size(), max);
  InstanceMetadata metadata = history.back().instances[instance].metadata;
  for (size_t i = 0; i < predicted.size(); ++i) {
    metadata.created = metadata.sent = metadata.arrived = predicted[i].time;
    const Prediction& made = (*values)[steps[i] - 1];
    InstancePrediction one{made.value, engine.model, made.error, {}};
    if (choice != nullptr) {
      ENGRAM_ASSIGN_OR_RETURN(one, choice->by_model(instance, engine, made));
    }
    predicted[i].append(std::move(one.value), metadata, one.error.expected, one.error.bound);
    predicted[i].instances.back().members = std::move(one.members);
  }
  return {};
}

}  // namespace

Result<std::vector<Engine>> RecallPredictor::engines(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(std::vector<Engine> engines, past_.models(entity));
  const auto copies = [this](const Engine& engine) {
    return engine.predictor->name() == copy_last_->name();
  };
  if (std::ranges::none_of(engines, copies)) engines.push_back({copy_last_.get(), ""});
  return engines;
}

Result<Engine> RecallPredictor::engine(const MemoryId& entity, const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
  std::string names;
  for (const Engine& engine : known) {
    if (name.empty() || engine.predictor->name() == name) return engine;
    names += (names.empty() ? "" : ", ") + std::string(engine.predictor->name());
  }
  return not_found("entity '{}': nothing named '{}' predicts it; there is: {}", entity.to_string(),
                   name, names);
}

Result<std::vector<SnapshotResult>> RecallPredictor::predict(const MemoryId& entity,
                                                             const PredictionRequest& request,
                                                             const Options& options) {
  const Cleared cleared{conditions_};
  if (!make_choice_ || request.plan) return predict_planned(entity, request, options);
  ENGRAM_ASSIGN_OR_RETURN(Learned * learned,
                          this->learned(entity, request.from, options.prefer, request.goes_on()));
  ENGRAM_RETURN_IF_ERROR(check_horizons(entity, request, learned->last, options.max_horizon));
  return learned->choice->predict(request.horizons, request.engine);
}

/// Predicts with one engine and, if the request has one, a plan.
Result<std::vector<SnapshotResult>> RecallPredictor::predict_planned(
    const MemoryId& entity, const PredictionRequest& request, const Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, known(entity));
  ENGRAM_ASSIGN_OR_RETURN(const Engine used, engine(entity, request.engine));
  Predictor& predictor = *used.predictor;
  if (request.plan && !predictor.condition())
    return invalid_argument(
        "entity '{}': '{}' starts from no other entity, a plan tells it nothing",
        entity.to_string(), predictor.name());
  ENGRAM_ASSIGN_OR_RETURN(const auto last, last_known(*past, request.from));
  if (!last) return has_none_before(entity, request.from);
  ENGRAM_RETURN_IF_ERROR(check_horizons(entity, request, *last, options.max_horizon));
  ENGRAM_ASSIGN_OR_RETURN(const auto moments,
                          latest(*past, last, std::max<size_t>(predictor.context(), 1)));
  std::vector<SnapshotResult> history;
  for (const Time moment : moments) {
    auto one = read(*past, moment, options.prefer);
    if (is_unreadable(one.status()) && moment != *last) {
      history.clear();  // A model continues only consecutive snapshots.
      continue;
    }
    ENGRAM_RETURN_IF_ERROR(one.status());
    history.push_back(*std::move(one));
  }
  std::vector<SnapshotResult> predicted;
  std::vector<size_t> steps;
  for (const Duration horizon : request.horizons) {
    steps.push_back(steps_to(predictor, horizon));
    SnapshotResult& one = predicted.emplace_back();
    one.source = Source::kPredicted;
    one.model = used.model;
    one.predictor = predictor.name();
    one.horizon = horizon;
    one.time = *last + horizon;
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto conditions, conditions_of(predictor, history, options.prefer));
  std::vector<idf::Data> plan;
  if (request.plan && conditions.size() == history.size()) {
    ENGRAM_ASSIGN_OR_RETURN(
        plan, plan_of(predictor, *request.plan, *last, std::ranges::max(steps), options.prefer));
    for (SnapshotResult& one : predicted) one.plan = plan.empty() ? "" : request.plan->to_string();
  }
  EngineChoice* choice = nullptr;
  if (make_choice_) {
    ENGRAM_ASSIGN_OR_RETURN(Learned * learned,
                            this->learned(entity, last, options.prefer, request.goes_on()));
    choice = learned->choice.get();
  }
  for (size_t i = 0; i < history.back().instances.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(
        predict_instance(entity, used, history, i, {conditions, plan}, steps, choice, predicted));
  if (choice != nullptr)
    for (SnapshotResult& one : predicted) one.predictor = engine_of(one, one.predictor);
  return predicted;
}

Result<std::vector<EngineRecord>> RecallPredictor::records(const MemoryId& entity,
                                                           std::optional<Time> from, Duration ahead,
                                                           const Options& options) {
  const Cleared cleared{conditions_};
  if (make_choice_) {
    ENGRAM_ASSIGN_OR_RETURN(Learned * learned,
                            this->learned(entity, from, options.prefer, !from.has_value()));
    return learned->choice->records(ahead);
  }
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
  std::vector<EngineRecord> records;
  for (const Engine& engine : known)
    records.push_back({std::string(engine.predictor->name()), engine.model});
  return records;
}

Result<std::unique_ptr<EntityPast>> RecallPredictor::known(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(auto past, past_.of(entity));
  if (!past) return not_found("{}: has no entity '{}'", past_.name(), entity.to_string());
  return past;
}

/// The engines of an entity, after they learned from its snapshots up to `from`.
Result<RecallPredictor::Learned*> RecallPredictor::learned(const MemoryId& entity,
                                                           std::optional<Time> from, Prefer prefer,
                                                           bool goes_on) {
  if (std::exchange(era_, past_.era()) != past_.era()) learned_.clear();
  ENGRAM_ASSIGN_OR_RETURN(const auto past, known(entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto last, last_known(*past, from));
  if (!last) return has_none_before(entity, from);
  ENGRAM_ASSIGN_OR_RETURN(const auto models, models_of(entity));
  const auto found = std::ranges::find_if(learned_, [&](const Learned& one) {
    return one.entity == entity && one.prefer == prefer && one.goes_on == goes_on;
  });
  if (found != learned_.end()) {
    learned_.splice(learned_.begin(), learned_, found);
    if (found->last == *last && found->models == models) return &learned_.front();
  }
  // Engines cannot unlearn, so they start again for an earlier moment, or if a model was published.
  const bool continues =
      goes_on && found != learned_.end() && found->last < *last && found->models == models;
  Learned renewed;
  if (continues) renewed = std::move(learned_.front());
  if (found != learned_.end()) learned_.pop_front();
  if (!continues) renewed = {entity, prefer, goes_on, {}, {}, 0, nullptr};
  ENGRAM_RETURN_IF_ERROR(update(renewed, *past, *last));
  learned_.push_front(std::move(renewed));
  if (learned_.size() > kMaxLearned) learned_.pop_back();
  return &learned_.front();
}

/// Lets an entity's engines learn the new snapshots up to `last`. They start again if there are
/// none yet, or if more snapshots came than they look back for.
Status RecallPredictor::update(Learned& learned, EntityPast& past, Time last) {
  ENGRAM_ASSIGN_OR_RETURN(SnapshotResult read, ltm::read(past, last, learned.prefer));
  Snapshot newest = to_snapshot(learned.entity, std::move(read));
  std::vector<Time> moments;
  if (learned.choice) {
    ENGRAM_ASSIGN_OR_RETURN(moments, latest(past, last, learned.wanted + 1, learned.last));
  }
  if (!learned.choice || moments.size() > learned.wanted) {
    ENGRAM_ASSIGN_OR_RETURN(learned, begun(learned, newest));
    ENGRAM_ASSIGN_OR_RETURN(moments, latest(past, last, learned.wanted));
  }
  return add_new(learned, past, moments, std::move(newest));
}

/// What `learned` is for, with engines that learned nothing yet.
Result<RecallPredictor::Learned> RecallPredictor::begun(const Learned& learned,
                                                        const Snapshot& newest) {
  const MemoryId& entity = learned.entity;
  const Prefer prefer = learned.prefer;
  EngineChoiceInputs inputs{entity, past_.type_of(entity), {}, {}};
  // These are the models alone: a choice measures a plain copy of the last snapshot by itself.
  ENGRAM_ASSIGN_OR_RETURN(inputs.models, past_.models(entity));
  inputs.condition_at = [this, prefer](const MemoryId& condition, Time time) {
    return condition_at(condition, time, prefer);
  };
  ENGRAM_ASSIGN_OR_RETURN(auto models, models_of(entity));
  auto choice = make_choice_(std::move(inputs));
  const size_t wanted = std::max<size_t>(choice->snapshots_wanted(newest), 1);
  return Learned{entity, prefer, learned.goes_on, std::move(models), {}, wanted, std::move(choice)};
}

/// Adds the snapshots of an entity at `moments`; `newest` is the snapshot at the last of them.
Status RecallPredictor::add_new(Learned& learned, EntityPast& past, std::span<const Time> moments,
                                Snapshot newest) {
  for (const Time moment : moments.first(moments.size() - 1)) {
    auto one = read(past, moment, learned.prefer);
    if (is_unreadable(one.status())) continue;
    ENGRAM_RETURN_IF_ERROR(one.status());
    ENGRAM_RETURN_IF_ERROR(learned.choice->add(to_snapshot(learned.entity, *std::move(one))));
  }
  learned.last = newest.time;
  return learned.choice->add(newest);
}

Result<std::vector<std::string>> RecallPredictor::models_of(const MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> models, past_.models(entity));
  std::vector<std::string> names;
  for (const Engine& model : models) names.push_back(model.model);
  return names;
}

/// The value of an entity at a time: the first instance of its last snapshot at or before it.
Result<std::optional<idf::Data>> RecallPredictor::condition_at(const MemoryId& entity, Time time,
                                                               Prefer prefer) {
  auto known = conditions_.find(entity);
  if (known == conditions_.end()) {
    ENGRAM_ASSIGN_OR_RETURN(auto past, past_.of(entity));
    known = conditions_.emplace(entity, std::move(past)).first;
  }
  if (!known->second) return std::optional<idf::Data>();
  ENGRAM_ASSIGN_OR_RETURN(const auto moment, known->second->at_or_before(time));
  if (!moment) return std::optional<idf::Data>();
  auto past = read(*known->second, *moment, prefer);
  if (is_unreadable(past.status())) return std::optional<idf::Data>();
  ENGRAM_RETURN_IF_ERROR(past.status());
  if (past->instances.empty()) return std::optional<idf::Data>();
  return std::optional(std::move(past->instances.front().data));
}

/// The values of a predictor's condition at the times of `history`; empty if one is not known.
Result<std::vector<idf::Data>> RecallPredictor::conditions_of(
    const Predictor& predictor, std::span<const SnapshotResult> history, Prefer prefer) {
  const std::optional<MemoryId> entity = predictor.condition();
  if (!entity) return std::vector<idf::Data>{};
  std::vector<idf::Data> conditions;
  for (const SnapshotResult& past : history) {
    ENGRAM_ASSIGN_OR_RETURN(auto known, condition_at(*entity, past.time, prefer));
    if (!known) return std::vector<idf::Data>{};
    conditions.push_back(std::move(*known));
  }
  return conditions;
}

/// The planned values for `steps` steps after `last` and one more, as motion looks two steps ahead.
/// Empty if nothing is planned after `last` up to its first step.
Result<std::vector<idf::Data>> RecallPredictor::plan_of(const Predictor& predictor,
                                                        const MemoryId& entity, Time last,
                                                        size_t steps, Prefer prefer) {
  std::vector<idf::Data> plan;
  ENGRAM_ASSIGN_OR_RETURN(const auto past, known(entity));
  const int64_t step_ns = predictor.step().count();
  const auto wanted = static_cast<int64_t>(steps) + 1;
  if (step_ns > (INT64_MAX - std::max<int64_t>(0, to_ns(last))) / wanted) return plan;
  for (int64_t step = 1; step <= wanted; ++step) {
    const Time moment = last + predictor.step() * step;
    ENGRAM_ASSIGN_OR_RETURN(const auto planned, past->at_or_before(moment));
    if (!planned || *planned <= last) break;
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult value, read(*past, *planned, prefer));
    if (value.instances.empty()) break;
    plan.push_back(std::move(value.instances.front().data));
  }
  return plan;
}

}  // namespace engram::ltm
