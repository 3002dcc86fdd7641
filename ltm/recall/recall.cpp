// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/recall.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "ltm/recall/select.h"

namespace engram::ltm {

namespace {

/// Instances of consecutive snapshots as one series of values per instance index.
std::vector<idf::Data> series(const std::vector<SnapshotResult>& history, size_t instance) {
  std::vector<idf::Data> values;
  for (const SnapshotResult& past : history)
    if (instance < past.instances.size()) values.push_back(past.instances[instance].data);
  return values;
}

void append_instance(SnapshotResult& snapshot, idf::Data data, const InstanceMetadata& metadata,
                     std::optional<MeasuredError> error, std::optional<MeasuredError> bound = {}) {
  const auto index = static_cast<int32_t>(snapshot.instances.size());
  snapshot.instances.push_back({index, std::move(data), metadata, error, bound});
}

/// Leaves the instances that are asked for. False where none of them exists.
bool keep_selected(SnapshotResult& snapshot, const std::vector<int32_t>& instances) {
  if (instances.empty()) return true;
  std::erase_if(snapshot.instances, [&instances](const InstanceResult& instance) {
    return !std::ranges::binary_search(instances, instance.index);
  });
  return !snapshot.instances.empty();
}

/// The times of a store's entity.
class TimelineMoments final : public Moments {
 public:
  explicit TimelineMoments(Timeline& timeline) : timeline_(timeline) {}

  [[nodiscard]] std::optional<Time> first() const override { return timeline_.first(); }
  [[nodiscard]] std::optional<Time> last() const override { return timeline_.last(); }
  Result<std::optional<Time>> at_or_after(Time time) override {
    return time_of(timeline_.at_or_after(time));
  }
  Result<std::optional<Time>> at_or_before(Time time) override {
    return time_of(timeline_.at_or_before(time));
  }
  Result<std::optional<Time>> nth(uint64_t index) override { return time_of(timeline_.nth(index)); }

 private:
  static Result<std::optional<Time>> time_of(const Result<std::optional<SnapshotEntry>>& entry) {
    if (!entry.ok()) return entry.status();
    return entry.value() ? std::optional((*entry)->time) : std::nullopt;
  }

  Timeline& timeline_;
};

}  // namespace

struct Recall::State {
  std::unique_ptr<StoreReader> store;
  ModelLoader loader;
  std::unique_ptr<AccessLog> accesses;        ///< May be null.
  std::map<std::string, LoadedModel> models;  ///< By file.
  std::unique_ptr<Predictor> copy_last = make_copy_last_predictor();

  Result<LoadedModel*> load(const ModelInfo& info) {
    if (const auto known = models.find(info.file); known != models.end()) return &known->second;
    if (!loader)
      return failed_precondition("model {}: this program was built without learning", info.name());
    auto model = loader(store->path() / info.file);
    if (!model.ok()) return model.status().with_context("model " + info.name());
    return &models.emplace(info.file, std::move(model).value()).first->second;
  }

  Result<const ModelInfo*> find_model(const MemoryId& entity, int version) const {
    for (const ModelInfo& model : store->manifest().models)
      if (model.entity == entity && model.version == version) return &model;
    return data_loss("store '{}': latents of '{}' name model v{}, which is not there",
                     store->path().string(), entity.to_string(), version);
  }

  Result<SnapshotResult> read_recorded(const MemoryId& entity, const SnapshotEntry& entry) {
    ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, store->read_recorded(entity, entry));
    SnapshotResult recalled;
    recalled.time = snapshot.time;
    for (Instance& instance : snapshot.instances)
      append_instance(recalled, std::move(instance.data), instance.metadata, {});
    return recalled;
  }

  Result<SnapshotResult> reconstruct(const MemoryId& entity, const SnapshotEntry& entry) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, store->read_latent(entity, entry));
    ENGRAM_ASSIGN_OR_RETURN(const ModelInfo* info, find_model(entity, latents.model_version));
    ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, load(*info));
    SnapshotResult recalled;
    recalled.source = Source::kReconstructed;
    recalled.model = info->name();
    recalled.time = entry.time;
    std::vector<Latent> codes;
    for (const LatentInstance& instance : latents.instances) codes.push_back(instance.latent);
    auto values = model->encoder->decode(codes);
    if (!values.ok())
      return values.status().with_context(entity.at(entry.time).to_string() + ", " + info->name());
    if (values->size() != codes.size())
      return data_loss("model {}: gave {} values for {} latents", info->name(), values->size(),
                       codes.size());
    for (size_t i = 0; i < latents.instances.size(); ++i)
      append_instance(recalled, std::move((*values)[i]), latents.instances[i].metadata,
                      latents.instances[i].error);
    return recalled;
  }

  static bool uses_latent(const SnapshotEntry& entry, Prefer prefer) {
    return entry.latent && (!entry.recorded || prefer == Prefer::kLatent);
  }

  Result<SnapshotResult> read(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer) {
    return uses_latent(entry, prefer) ? reconstruct(entity, entry) : read_recorded(entity, entry);
  }

  /// The instances of a snapshot without their data.
  Result<SnapshotResult> name(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer) {
    const bool is_latent = uses_latent(entry, prefer);
    size_t count = is_latent ? entry.latent->rows : entry.recorded->rows;
    if (count == 0 && !is_latent) {
      ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, store->read_packed(entity, entry));
      count = packed.instances.size();
    }
    SnapshotResult named;
    named.time = entry.time;
    named.source = is_latent ? Source::kReconstructed : Source::kRecorded;
    for (size_t i = 0; i < count; ++i) append_instance(named, {}, {}, {});
    return named;
  }

  /// The instances of a prediction without their data.
  Result<SnapshotResult> name_future(const MemoryId& entity, const SnapshotEntry& last, Time when,
                                     Prefer prefer) {
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult named, name(entity, last, prefer));
    named.time = when;
    named.source = Source::kPredicted;
    named.horizon = when - last.time;
    return named;
  }

  Result<std::vector<Engine>> engines(const MemoryId& entity) {
    const ModelInfo* newest = store->manifest().newest_model(entity);
    if (newest == nullptr || !loader) return std::vector<Engine>{{copy_last.get(), ""}};
    ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, load(*newest));
    std::vector<Engine> engines;
    if (model->predictor) engines.push_back({model->predictor.get(), newest->name()});
    engines.push_back({model->copy_last ? model->copy_last.get() : copy_last.get(), ""});
    return engines;
  }

  Result<Engine> engine(const MemoryId& entity, const std::string& name) {
    ENGRAM_ASSIGN_OR_RETURN(const std::vector<Engine> known, engines(entity));
    std::string names;
    for (const Engine& engine : known) {
      if (name.empty() || engine.predictor->name() == name) return engine;
      names += (names.empty() ? "" : ", ") + std::string(engine.predictor->name());
    }
    return not_found("entity '{}': nothing named '{}' predicts it; there is: {}",
                     entity.to_string(), name, names);
  }

  /// The last snapshots of the entity up to a moment, at most `count`, in the order of time.
  static Result<std::vector<SnapshotEntry>> latest(Timeline& timeline, std::optional<Time> time,
                                                   size_t count) {
    std::vector<SnapshotEntry> entries;
    while (time && entries.size() < count) {
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(*time));
      if (!entry) break;
      entries.push_back(*entry);
      time = to_ns(entry->time) == INT64_MIN ? std::nullopt
                                             : std::optional(time_from_ns(to_ns(entry->time) - 1));
    }
    std::ranges::reverse(entries);
    return entries;
  }

  Result<std::vector<SnapshotResult>> predict(const MemoryId& entity, const Outlook& outlook,
                                              const Options& options) {
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store->timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(const Engine used, engine(entity, outlook.engine));
    Predictor& predictor = *used.predictor;
    if (outlook.plan && !predictor.condition())
      return invalid_argument(
          "entity '{}': '{}' starts from no other entity, a plan tells it nothing",
          entity.to_string(), predictor.name());
    ENGRAM_ASSIGN_OR_RETURN(const auto entries,
                            latest(*timeline, outlook.from ? outlook.from : timeline->last(),
                                   std::max<size_t>(predictor.context(), 1)));
    if (entries.empty())
      return not_found("entity '{}': has no snapshot at or before {}", entity.to_string(),
                       outlook.from ? to_string(*outlook.from) : "now");
    std::vector<SnapshotResult> history;
    for (const SnapshotEntry& entry : entries) {
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult past, read(entity, entry, options.prefer));
      history.push_back(std::move(past));
    }
    std::vector<SnapshotResult> predicted;
    std::vector<size_t> steps;
    for (const Duration horizon : outlook.horizons) {
      if (horizon.count() < 0 ||
          horizon.count() > INT64_MAX - std::max<int64_t>(0, to_ns(entries.back().time)))
        return invalid_argument("entity '{}': found a horizon of {}, needs a moment after {}",
                                entity.to_string(), engram::to_string(horizon),
                                engram::to_string(entries.back().time));
      ENGRAM_ASSIGN_OR_RETURN(const int ahead, steps_to(predictor, horizon, entity, options));
      steps.push_back(static_cast<size_t>(ahead));
      SnapshotResult& one = predicted.emplace_back();
      one.source = Source::kPredicted;
      one.model = used.model;
      one.predictor = predictor.name();
      one.horizon = horizon;
      one.time = entries.back().time + horizon;
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto conditions,
                            conditions_of(predictor, entries, options.prefer));
    std::vector<idf::Data> plan;
    if (outlook.plan && conditions.size() == history.size()) {
      ENGRAM_ASSIGN_OR_RETURN(plan, plan_of(predictor, *outlook.plan, entries.back().time,
                                            std::ranges::max(steps), options.prefer));
      for (SnapshotResult& one : predicted)
        one.plan = plan.empty() ? "" : outlook.plan->to_string();
    }
    for (size_t i = 0; i < history.back().instances.size(); ++i)
      ENGRAM_RETURN_IF_ERROR(
          predict_instance(entity, used, history, i, {conditions, plan}, steps, predicted));
    return predicted;
  }

  /// What a prediction is told beside the past of its entity, as in Past.
  struct ToldValues {
    std::span<const idf::Data> conditions, plan;
  };

  /// Adds one instance to each of `predicted`, so many steps ahead.
  static Status predict_instance(const MemoryId& entity, const Engine& engine,
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
      return data_loss("model {}: predicted {} steps, needs {}", engine.model, values->size(),
                       most);
    InstanceMetadata metadata = history.back().instances[instance].metadata;
    for (size_t i = 0; i < predicted.size(); ++i) {
      metadata.created = metadata.sent = metadata.arrived = predicted[i].time;
      const Prediction& one = (*values)[steps[i] - 1];
      append_instance(predicted[i], one.value, metadata, one.error.expected, one.error.bound);
    }
    return {};
  }

  /// What a predictor's condition was at the times of `entries`; empty where one is not known.
  Result<std::vector<idf::Data>> conditions_of(const Predictor& predictor,
                                               std::span<const SnapshotEntry> entries,
                                               Prefer prefer) {
    const std::optional<MemoryId> entity = predictor.condition();
    if (!entity) return std::vector<idf::Data>{};
    auto timeline = store->timeline(*entity);
    if (timeline.status().code() == StatusCode::kNotFound) return std::vector<idf::Data>{};
    ENGRAM_RETURN_IF_ERROR(timeline.status());
    std::vector<idf::Data> conditions;
    for (const SnapshotEntry& entry : entries) {
      ENGRAM_ASSIGN_OR_RETURN(const auto known, (*timeline)->at_or_before(entry.time));
      if (!known) return std::vector<idf::Data>{};
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult past, read(*entity, *known, prefer));
      if (past.instances.empty()) return std::vector<idf::Data>{};
      conditions.push_back(std::move(past.instances.front().data));
    }
    return conditions;
  }

  /// What is planned for so many steps after `last`, and one more: motion looks two ahead. None
  /// where the plan has ended before.
  Result<std::vector<idf::Data>> plan_of(const Predictor& predictor, const MemoryId& entity,
                                         Time last, size_t steps, Prefer prefer) {
    std::vector<idf::Data> plan;
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store->timeline(entity));
    const int64_t step_ns = predictor.step().count();
    const auto most = static_cast<int64_t>(steps) + 1;
    if (step_ns > (INT64_MAX - std::max<int64_t>(0, to_ns(last))) / most) return plan;
    for (int64_t step = 1; step <= most; ++step) {
      const Time moment = last + predictor.step() * step;
      ENGRAM_ASSIGN_OR_RETURN(const auto planned, timeline->at_or_before(moment));
      if (!planned || planned->time <= last) break;
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult value, read(entity, *planned, prefer));
      if (value.instances.empty()) break;
      plan.push_back(std::move(value.instances.front().data));
    }
    return plan;
  }

  /// The number of steps that comes closest to the horizon, at least one.
  static Result<int> steps_to(const Predictor& predictor, Duration horizon, const MemoryId& entity,
                              const Options& options) {
    if (predictor.step() <= Duration(0)) return 1;
    const double steps =
        std::max(1.0, std::round(to_seconds(horizon) / to_seconds(predictor.step())));
    if (steps > options.max_steps)
      return invalid_argument(
          "entity '{}': asked for a prediction {} ahead, at most {} ({} steps of {}) is possible",
          entity.to_string(), engram::to_string(horizon),
          engram::to_string(predictor.step() * options.max_steps), options.max_steps,
          engram::to_string(predictor.step()));
    return static_cast<int>(steps);
  }

  Result<SnapshotResult> answer(const MemoryId& entity, Timeline& timeline,
                                const SelectedSnapshot& selected, bool is_ids_only,
                                const Options& options) {
    if (selected.is_future && !is_ids_only) {
      const Duration horizon = selected.time - *timeline.last();
      ENGRAM_ASSIGN_OR_RETURN(auto predicted, predict(entity, {{}, {horizon}, ""}, options));
      return std::move(predicted.front());
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_before(selected.time));
    ENGRAM_CHECK(entry.has_value(), "'{}' was selected", entity.at(selected.time).to_string());
    if (selected.is_future) return name_future(entity, *entry, selected.time, options.prefer);
    return is_ids_only ? name(entity, *entry, options.prefer)
                       : read(entity, *entry, options.prefer);
  }

  Status answer(const Query& query, const Options& options, EntityResult& result) {
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store->timeline(result.id));
    TimelineMoments moments(*timeline);
    ENGRAM_ASSIGN_OR_RETURN(const auto selection,
                            select_snapshots(query.snapshots_of(result.id), moments));
    for (const SelectedSnapshot& selected : selection) {
      ENGRAM_ASSIGN_OR_RETURN(SnapshotResult snapshot,
                              answer(result.id, *timeline, selected, query.is_ids_only(), options));
      if (!keep_selected(snapshot, selected.instances)) continue;
      if (accesses && !selected.is_future && !query.is_ids_only())
        accesses->note(result.id, snapshot.time);
      result.add(std::move(snapshot));
    }
    return {};
  }
};

Recall::Recall(std::unique_ptr<StoreReader> store, ModelLoader loader,
               std::unique_ptr<AccessLog> accesses)
    : state_(std::make_unique<State>()) {
  state_->store = std::move(store);
  state_->loader = std::move(loader);
  state_->accesses = std::move(accesses);
}

Recall::~Recall() = default;

StoreReader& Recall::store() {
  return *state_->store;
}

Result<std::vector<Recall::Engine>> Recall::engines(const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(state_->store->timeline(entity).status());
  return state_->engines(entity);
}

Result<Recall::Engine> Recall::engine(const MemoryId& entity, const std::string& name) {
  ENGRAM_RETURN_IF_ERROR(state_->store->timeline(entity).status());
  return state_->engine(entity, name);
}

Result<std::vector<SnapshotResult>> Recall::predict(const MemoryId& entity, const Outlook& outlook,
                                                    const Options& options) {
  if (outlook.horizons.empty())
    return invalid_argument("entity '{}': found no horizon to predict, needs one",
                            entity.to_string());
  return state_->predict(entity, outlook, options);
}

Result<QueryResult> Recall::query(const Query& query, const Options& options) {
  QueryResult result(query.is_ids_only());
  bool is_any = false;
  std::string known;
  for (const MemoryId& entity : state_->store->entities()) {
    known += (known.empty() ? "" : ", ") + entity.to_string();
    if (!query.matches(entity)) continue;
    is_any = true;
    ENGRAM_RETURN_IF_ERROR(state_->answer(query, options, result.add_entity(entity)));
  }
  if (!is_any)
    return not_found("store '{}': no entity matches '{}'; it has: {}",
                     state_->store->path().string(), query.to_string(),
                     known.empty() ? "none" : known);
  return result;
}

}  // namespace engram::ltm
