// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/forecaster.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace engram::ltm {

namespace {

/// What a prediction is told beside the past of its entity, as in Past.
struct ToldValues {
  std::span<const idf::Data> conditions, plan;
};

/// Instances of consecutive snapshots as one series of values per instance index.
std::vector<idf::Data> series(const std::vector<SnapshotResult>& history, size_t instance) {
  std::vector<idf::Data> values;
  for (const SnapshotResult& past : history)
    if (instance < past.instances.size()) values.push_back(past.instances[instance].data);
  return values;
}

/// The last snapshots of the entity up to a moment, at most `count`, those after `after` alone, in
/// the order of time.
Result<std::vector<SnapshotEntry>> latest(Timeline& timeline, std::optional<Time> time,
                                          size_t count, std::optional<Time> after = {}) {
  std::vector<SnapshotEntry> entries;
  while (time && entries.size() < count) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(*time));
    if (!entry || (after && entry->time <= *after)) break;
    entries.push_back(*entry);
    time = to_ns(entry->time) == INT64_MIN ? std::nullopt
                                           : std::optional(time_from_ns(to_ns(entry->time) - 1));
  }
  std::ranges::reverse(entries);
  return entries;
}

/// The number of steps that comes closest to the horizon, at least one.
Result<size_t> steps_to(const Predictor& predictor, Time last, Duration horizon,
                        const MemoryId& entity, int max_steps) {
  if (horizon.count() < 0 || horizon.count() > INT64_MAX - std::max<int64_t>(0, to_ns(last)))
    return invalid_argument("entity '{}': found a horizon of {}, needs a moment after {}",
                            entity.to_string(), to_string(horizon), to_string(last));
  if (predictor.step() <= Duration(0)) return size_t{1};
  const double steps =
      std::max(1.0, std::round(to_seconds(horizon) / to_seconds(predictor.step())));
  if (steps > max_steps)
    return invalid_argument(
        "entity '{}': asked for a prediction {} ahead, at most {} ({} steps of {}) is possible",
        entity.to_string(), to_string(horizon), to_string(predictor.step() * max_steps), max_steps,
        to_string(predictor.step()));
  return static_cast<size_t>(steps);
}

Status has_none_before(const MemoryId& entity, std::optional<Time> from) {
  return not_found("entity '{}': has no snapshot at or before {}", entity.to_string(),
                   from ? to_string(*from) : "now");
}

Snapshot to_snapshot(const MemoryId& entity, SnapshotResult read) {
  Snapshot snapshot{entity, read.time, {}};
  for (InstanceResult& instance : read.instances)
    snapshot.instances.push_back({std::move(instance.data), std::move(instance.metadata)});
  return snapshot;
}

/// Adds one instance to each of `predicted`, so many steps ahead.
Status predict_instance(const MemoryId& entity, const Engine& engine,
                        const std::vector<SnapshotResult>& history, size_t instance,
                        const ToldValues& told, std::span<const size_t> steps,
                        std::vector<SnapshotResult>& predicted) {
  const std::vector<idf::Data> values_before = series(history, instance);
  Past past{values_before};
  if (told.conditions.size() == values_before.size()) {
    past.conditions = told.conditions;
    past.plan = told.plan;
  }
  const size_t most = std::ranges::max(steps);
  auto values = engine.predictor->predict(past, static_cast<int>(most));
  if (!values.ok()) return values.status().with_context("prediction of " + entity.to_string());
  if (values->size() < most)
    return data_loss("model {}: predicted {} steps, needs {}", engine.model, values->size(), most);
  InstanceMetadata metadata = history.back().instances[instance].metadata;
  for (size_t i = 0; i < predicted.size(); ++i) {
    metadata.created = metadata.sent = metadata.arrived = predicted[i].time;
    const Prediction& one = (*values)[steps[i] - 1];
    predicted[i].append(one.value, metadata, one.error.expected, one.error.bound);
  }
  return {};
}

}  // namespace

Result<std::vector<Engine>> Forecaster::engines(const MemoryId& entity) {
  const ModelInfo* newest = past_.store().manifest().newest_model(entity);
  if (newest == nullptr || !past_.has_loader()) return std::vector<Engine>{{copy_last_.get(), ""}};
  ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, past_.load(*newest));
  std::vector<Engine> engines;
  if (model->predictor) engines.push_back({model->predictor.get(), newest->name()});
  engines.push_back({model->copy_last ? model->copy_last.get() : copy_last_.get(), ""});
  return engines;
}

Result<Engine> Forecaster::engine(const MemoryId& entity, const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
  std::string names;
  for (const Engine& engine : known) {
    if (name.empty() || engine.predictor->name() == name) return engine;
    names += (names.empty() ? "" : ", ") + std::string(engine.predictor->name());
  }
  return not_found("entity '{}': nothing named '{}' predicts it; there is: {}", entity.to_string(),
                   name, names);
}

Result<std::vector<SnapshotResult>> Forecaster::predict(const MemoryId& entity,
                                                        const Outlook& outlook, Prefer prefer,
                                                        int max_steps) {
  if (make_choice_ && !outlook.plan) return predict_by_choice(entity, outlook, prefer, max_steps);
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, past_.store().timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(const Engine used, engine(entity, outlook.engine));
  Predictor& predictor = *used.predictor;
  if (outlook.plan && !predictor.condition())
    return invalid_argument(
        "entity '{}': '{}' starts from no other entity, a plan tells it nothing",
        entity.to_string(), predictor.name());
  ENGRAM_ASSIGN_OR_RETURN(const auto entries,
                          latest(*timeline, outlook.from ? outlook.from : timeline->last(),
                                 std::max<size_t>(predictor.context(), 1)));
  if (entries.empty()) return has_none_before(entity, outlook.from);
  const Time last = entries.back().time;
  ENGRAM_ASSIGN_OR_RETURN(const auto history, read_all(entity, entries, prefer));
  std::vector<SnapshotResult> predicted;
  std::vector<size_t> steps;
  for (const Duration horizon : outlook.horizons) {
    ENGRAM_ASSIGN_OR_RETURN(steps.emplace_back(),
                            steps_to(predictor, last, horizon, entity, max_steps));
    SnapshotResult& one = predicted.emplace_back();
    one.source = Source::kPredicted;
    one.model = used.model;
    one.predictor = predictor.name();
    one.horizon = horizon;
    one.time = last + horizon;
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto conditions, conditions_of(predictor, entries, prefer));
  std::vector<idf::Data> plan;
  if (outlook.plan && conditions.size() == history.size()) {
    ENGRAM_ASSIGN_OR_RETURN(
        plan, plan_of(predictor, *outlook.plan, last, std::ranges::max(steps), prefer));
    for (SnapshotResult& one : predicted) one.plan = plan.empty() ? "" : outlook.plan->to_string();
  }
  for (size_t i = 0; i < history.back().instances.size(); ++i)
    ENGRAM_RETURN_IF_ERROR(
        predict_instance(entity, used, history, i, {conditions, plan}, steps, predicted));
  return predicted;
}

Result<std::vector<SnapshotResult>> Forecaster::read_all(const MemoryId& entity,
                                                         std::span<const SnapshotEntry> entries,
                                                         Prefer prefer) {
  std::vector<SnapshotResult> history;
  for (const SnapshotEntry& entry : entries) {
    ENGRAM_ASSIGN_OR_RETURN(history.emplace_back(), past_.read(entity, entry, prefer));
  }
  return history;
}

Result<std::vector<SnapshotResult>> Forecaster::predict_by_choice(const MemoryId& entity,
                                                                  const Outlook& outlook,
                                                                  Prefer prefer, int max_steps) {
  ENGRAM_ASSIGN_OR_RETURN(Learned * learned, this->learned(entity, outlook.from, prefer));
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> models, engines(entity));
  for (const Engine& model : models) {
    if (!outlook.engine.empty() && outlook.engine != model.predictor->name()) continue;
    for (const Duration horizon : outlook.horizons)
      ENGRAM_RETURN_IF_ERROR(
          steps_to(*model.predictor, learned->last, horizon, entity, max_steps).status());
  }
  return learned->choice->predict(outlook.horizons, outlook.engine);
}

Result<std::vector<EngineRecord>> Forecaster::records(const MemoryId& entity,
                                                      std::optional<Time> from, Duration ahead,
                                                      Prefer prefer) {
  if (make_choice_) {
    ENGRAM_ASSIGN_OR_RETURN(Learned * learned, this->learned(entity, from, prefer));
    return learned->choice->records(ahead);
  }
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
  std::vector<EngineRecord> records;
  for (const Engine& engine : known)
    records.push_back({std::string(engine.predictor->name()), engine.model});
  return records;
}

/// The engines of an entity, having learned from what is known up to a moment.
Result<Forecaster::Learned*> Forecaster::learned(const MemoryId& entity, std::optional<Time> from,
                                                 Prefer prefer) {
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, past_.store().timeline(entity));
  ENGRAM_ASSIGN_OR_RETURN(auto entries, latest(*timeline, from ? from : timeline->last(), 1));
  if (entries.empty()) return has_none_before(entity, from);
  const Time last = entries.front().time;
  const bool goes_on = learned_ && learned_->entity == entity && learned_->prefer == prefer &&
                       learned_->last <= last;
  if (goes_on && learned_->last == last) return &*learned_;
  ENGRAM_ASSIGN_OR_RETURN(SnapshotResult newest, past_.read(entity, entries.front(), prefer));
  Snapshot snapshot = to_snapshot(entity, std::move(newest));
  if (goes_on) {
    ENGRAM_ASSIGN_OR_RETURN(entries, latest(*timeline, last, learned_->wanted + 1, learned_->last));
  }
  if (!goes_on || entries.size() > learned_->wanted) {
    learned_.reset();
    ENGRAM_ASSIGN_OR_RETURN(learned_, begun(entity, snapshot, prefer));
    ENGRAM_ASSIGN_OR_RETURN(entries, latest(*timeline, last, learned_->wanted));
  }
  const Status added = add_new(*learned_, entries, std::move(snapshot));
  if (!added.ok()) learned_.reset();
  ENGRAM_RETURN_IF_ERROR(added);
  return &*learned_;
}

Result<Forecaster::Learned> Forecaster::begun(const MemoryId& entity, const Snapshot& newest,
                                              Prefer prefer) {
  EngineChoiceInputs inputs{entity};
  if (const idf::Type* type = past_.store().manifest().types.of_entity(entity)) inputs.type = *type;
  ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
  // A plain copy of the last snapshot knows nothing that others do not measure.
  std::ranges::copy_if(known, std::back_inserter(inputs.models), [this](const Engine& engine) {
    return engine.predictor != copy_last_.get();
  });
  inputs.condition_at = [this, prefer](const MemoryId& condition, Time time) {
    return condition_at(condition, time, prefer);
  };
  auto choice = make_choice_(std::move(inputs));
  const size_t wanted = std::max<size_t>(choice->snapshots_wanted(newest), 1);
  return Learned{entity, prefer, {}, wanted, std::move(choice)};
}

/// Adds what `entries` hold, of which `newest` is the last one. Older ones that cannot be read are
/// left out: the last one alone is needed.
Status Forecaster::add_new(Learned& learned, std::span<const SnapshotEntry> entries,
                           Snapshot newest) {
  for (const SnapshotEntry& entry : entries.first(entries.size() - 1)) {
    auto read = past_.read(learned.entity, entry, learned.prefer);
    const StatusCode code = read.status().code();
    if (code == StatusCode::kDataLoss || code == StatusCode::kFailedPrecondition) continue;
    ENGRAM_RETURN_IF_ERROR(read.status());
    ENGRAM_RETURN_IF_ERROR(learned.choice->add(to_snapshot(learned.entity, std::move(*read))));
  }
  learned.last = newest.time;
  return learned.choice->add(newest);
}

/// What an entity was at a time: the first instance of its last snapshot at or before it.
Result<std::optional<idf::Data>> Forecaster::condition_at(const MemoryId& entity, Time time,
                                                          Prefer prefer) {
  auto timeline = past_.store().timeline(entity);
  if (timeline.status().code() == StatusCode::kNotFound) return std::optional<idf::Data>();
  ENGRAM_RETURN_IF_ERROR(timeline.status());
  ENGRAM_ASSIGN_OR_RETURN(const auto known, (*timeline)->at_or_before(time));
  if (!known) return std::optional<idf::Data>();
  ENGRAM_ASSIGN_OR_RETURN(SnapshotResult past, past_.read(entity, *known, prefer));
  if (past.instances.empty()) return std::optional<idf::Data>();
  return std::optional(std::move(past.instances.front().data));
}

/// What a predictor's condition was at the times of `entries`; empty where one is not known.
Result<std::vector<idf::Data>> Forecaster::conditions_of(const Predictor& predictor,
                                                         std::span<const SnapshotEntry> entries,
                                                         Prefer prefer) {
  const std::optional<MemoryId> entity = predictor.condition();
  if (!entity) return std::vector<idf::Data>{};
  std::vector<idf::Data> conditions;
  for (const SnapshotEntry& entry : entries) {
    ENGRAM_ASSIGN_OR_RETURN(auto known, condition_at(*entity, entry.time, prefer));
    if (!known) return std::vector<idf::Data>{};
    conditions.push_back(std::move(*known));
  }
  return conditions;
}

/// What is planned for so many steps after `last`, and one more: motion looks two ahead. None
/// where the plan has ended before.
Result<std::vector<idf::Data>> Forecaster::plan_of(const Predictor& predictor,
                                                   const MemoryId& entity, Time last, size_t steps,
                                                   Prefer prefer) {
  std::vector<idf::Data> plan;
  ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, past_.store().timeline(entity));
  const int64_t step_ns = predictor.step().count();
  const auto most = static_cast<int64_t>(steps) + 1;
  if (step_ns > (INT64_MAX - std::max<int64_t>(0, to_ns(last))) / most) return plan;
  for (int64_t step = 1; step <= most; ++step) {
    const Time moment = last + predictor.step() * step;
    ENGRAM_ASSIGN_OR_RETURN(const auto planned, timeline->at_or_before(moment));
    if (!planned || planned->time <= last) break;
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult value, past_.read(entity, *planned, prefer));
    if (value.instances.empty()) break;
    plan.push_back(std::move(value.instances.front().data));
  }
  return plan;
}

}  // namespace engram::ltm
