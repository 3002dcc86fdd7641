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
std::vector<idf::Data> series(const std::vector<RecalledSnapshot>& history, size_t instance) {
  std::vector<idf::Data> values;
  for (const RecalledSnapshot& past : history)
    if (instance < past.snapshot.instances.size())
      values.push_back(past.snapshot.instances[instance].data);
  return values;
}

}  // namespace

struct Recall::State {
  std::unique_ptr<StoreReader> store;
  ModelLoader loader;
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

  Result<RecalledSnapshot> read_recorded(const MemoryId& entity, const SnapshotEntry& entry) {
    RecalledSnapshot recalled;
    ENGRAM_ASSIGN_OR_RETURN(recalled.snapshot, store->read_recorded(entity, entry));
    return recalled;
  }

  Result<RecalledSnapshot> reconstruct(const MemoryId& entity, const SnapshotEntry& entry) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, store->read_latent(entity, entry));
    ENGRAM_ASSIGN_OR_RETURN(const ModelInfo* info, find_model(entity, latents.model_version));
    ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, load(*info));
    RecalledSnapshot recalled;
    recalled.source = Source::kReconstructed;
    recalled.model = info->name();
    recalled.snapshot = {entity, entry.time, {}};
    std::vector<Latent> codes;
    for (const LatentInstance& instance : latents.instances) codes.push_back(instance.latent);
    auto values = model->encoder->decode(codes);
    if (!values.ok())
      return values.status().with_context(entity.at(entry.time).to_string() + ", " + info->name());
    if (values->size() != codes.size())
      return data_loss("model {}: gave {} values for {} latents", info->name(), values->size(),
                       codes.size());
    for (size_t i = 0; i < latents.instances.size(); ++i) {
      recalled.snapshot.instances.push_back(
          {std::move((*values)[i]), latents.instances[i].metadata});
      recalled.errors.push_back(latents.instances[i].error);
    }
    return recalled;
  }

  Result<RecalledSnapshot> read(const MemoryId& entity, const SnapshotEntry& entry, Prefer prefer) {
    const bool use_latent = entry.latent && (!entry.recorded || prefer == Prefer::kLatent);
    return use_latent ? reconstruct(entity, entry) : read_recorded(entity, entry);
  }

  /// The predictor of the entity's newest model, or copy-last where there is none.
  Result<Predictor*> predictor_of(const MemoryId& entity, std::string& model_name) {
    const ModelInfo* newest = nullptr;
    for (const ModelInfo& model : store->manifest().models)
      if (model.entity == entity && (newest == nullptr || model.version > newest->version))
        newest = &model;
    if (newest == nullptr || !loader) return copy_last.get();
    ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, load(*newest));
    if (model->predictor == nullptr) return copy_last.get();
    model_name = newest->name();
    return model->predictor.get();
  }

  Result<RecalledSnapshot> predict(const MemoryId& entity, const std::vector<SnapshotEntry>& entries,
                                   Time when, const Options& options) {
    std::string model_name;
    ENGRAM_ASSIGN_OR_RETURN(Predictor * predictor, predictor_of(entity, model_name));
    const size_t context = std::min(predictor->context(), entries.size());
    std::vector<RecalledSnapshot> history;
    for (size_t i = entries.size() - context; i < entries.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(RecalledSnapshot past, read(entity, entries[i], options.prefer));
      history.push_back(std::move(past));
    }
    RecalledSnapshot recalled;
    recalled.source = Source::kPredicted;
    recalled.model = model_name;
    recalled.predictor = predictor->name();
    recalled.horizon = when - entries.back().time;
    recalled.snapshot = {entity, when, {}};
    ENGRAM_ASSIGN_OR_RETURN(const int steps, steps_to(*predictor, recalled.horizon, entity, options));
    const auto& last = history.back().snapshot.instances;
    for (size_t i = 0; i < last.size(); ++i) {
      auto values = predictor->predict(series(history, i), steps);
      if (!values.ok())
        return values.status().with_context("prediction of " + entity.to_string());
      if (values->empty()) return data_loss("model {}: predicted nothing", model_name);
      InstanceMetadata metadata = last[i].metadata;
      metadata.created = metadata.sent = metadata.arrived = when;
      recalled.snapshot.instances.push_back({std::move(values->back()), metadata});
      recalled.errors.push_back(predictor->expected_error(steps));
    }
    return recalled;
  }

  /// The number of steps that comes closest to the horizon, at least one.
  static Result<int> steps_to(const Predictor& predictor, Duration horizon, const MemoryId& entity,
                              const Options& options) {
    if (predictor.step() <= Duration(0)) return 1;
    const double steps = std::max(1.0, std::round(to_seconds(horizon) / to_seconds(predictor.step())));
    if (steps > options.max_steps)
      return invalid_argument(
          "entity '{}': asked for a prediction {} ahead, at most {} ({} steps of {}) is possible",
          entity.to_string(), engram::to_string(horizon),
          engram::to_string(predictor.step() * options.max_steps), options.max_steps,
          engram::to_string(predictor.step()));
    return static_cast<int>(steps);
  }

  Result<RecalledEntity> answer(const MemoryId& entity, const Selector& selector,
                                const Options& options) {
    ENGRAM_ASSIGN_OR_RETURN(const auto* entries, store->index(entity));
    std::vector<Time> times;
    times.reserve(entries->size());
    for (const SnapshotEntry& entry : *entries) times.push_back(entry.time);
    const Selection selection = select_times(selector, times);
    RecalledEntity result{entity, {}};
    if (selection.future) {
      ENGRAM_ASSIGN_OR_RETURN(auto predicted, predict(entity, *entries, *selection.future, options));
      result.snapshots.push_back(std::move(predicted));
    }
    for (size_t i = selection.first; i < selection.first + selection.count; ++i) {
      ENGRAM_ASSIGN_OR_RETURN(auto recalled, read(entity, (*entries)[i], options.prefer));
      result.snapshots.push_back(std::move(recalled));
    }
    return result;
  }
};

std::string_view to_string(Source source) {
  switch (source) {
    case Source::kRecorded: return "recorded";
    case Source::kReconstructed: return "reconstructed";
    case Source::kPredicted: return "predicted";
  }
  return "unknown";
}

Recall::Recall(std::unique_ptr<StoreReader> store, ModelLoader loader)
    : state_(std::make_unique<State>()) {
  state_->store = std::move(store);
  state_->loader = std::move(loader);
}

Recall::~Recall() = default;

StoreReader& Recall::store() { return *state_->store; }

Result<QueryResult> Recall::query(const Query& query, const Options& options) {
  QueryResult result;
  std::string known;
  for (const MemoryId& entity : state_->store->entities()) {
    known += (known.empty() ? "" : ", ") + entity.to_string();
    if (!query.matches(entity)) continue;
    ENGRAM_ASSIGN_OR_RETURN(RecalledEntity recalled,
                            state_->answer(entity, query.selector(), options));
    result.entities.push_back(std::move(recalled));
  }
  if (result.entities.empty())
    return not_found("store '{}': no entity matches '{}'; it has: {}",
                     state_->store->path().string(), query.to_string(),
                     known.empty() ? "none" : known);
  return result;
}

}  // namespace engram::ltm
