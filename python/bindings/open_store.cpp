// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/open_store.h"

#include <cmath>

#include "encoders/load_model.h"
#include "python/bindings/errors.h"
#include "python/bindings/values.h"
#include "server/prediction/entity_forecaster.h"

namespace engram::python {

namespace {

namespace py = pybind11;

py::object number_or_none(double value) {
  return std::isnan(value) ? py::object(py::none()) : py::object(py::float_(value));
}

py::object error_of(const std::optional<ltm::MeasuredError>& error) {
  if (!error) return py::none();
  py::dict dict;
  dict["image_mse"] = number_or_none(error->image_mse);
  dict["number_mse"] = number_or_none(error->number_mse);
  return dict;
}

py::dict instance_of(const ltm::InstanceResult& instance) {
  const ltm::InstanceMetadata& about = instance.metadata;
  py::dict dict;
  dict["index"] = instance.index;
  dict["value"] = to_python(instance.data);
  dict["created"] = to_ns(about.created);
  dict["sent"] = to_ns(about.sent);
  dict["arrived"] = to_ns(about.arrived);
  dict["provider"] = about.provider;
  dict["confidence"] = about.confidence;
  dict["origin"] = about.origin.to_string();
  dict["recipe"] = about.recipe;
  dict["error"] = error_of(instance.error);
  dict["bound"] = error_of(instance.bound);
  return dict;
}

py::list snapshots_of(const ltm::EntityResult& entity) {
  py::list snapshots;
  for (const ltm::SnapshotResult& found : entity.snapshots) {
    py::list instances;
    for (const ltm::InstanceResult& instance : found.instances)
      instances.append(instance_of(instance));
    py::dict dict;
    dict["entity"] = entity.id.to_string();
    dict["time"] = to_ns(found.time);
    dict["source"] = std::string(ltm::to_string(found.source));
    dict["model"] = found.model;
    dict["predictor"] = found.predictor;
    dict["horizon"] = found.horizon.count();
    dict["instances"] = std::move(instances);
    snapshots.append(std::move(dict));
  }
  return snapshots;
}

ltm::Recall::Options options_of(bool prefers_latents) {
  ltm::Recall::Options options;
  if (prefers_latents) options.prefer = ltm::Prefer::kLatent;
  return options;
}

Result<ltm::MemoryId> entity_of(const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(name));
  if (id.is_entity()) return id;
  return invalid_argument("'{}': needs an entity, four names", name);
}

Result<std::vector<int64_t>> times_behind(ltm::Timeline& timeline, std::optional<int64_t> after,
                                          size_t count) {
  std::vector<int64_t> times;
  Time from = Time::min();
  if (after) {
    if (time_from_ns(*after) == Time::max()) return times;
    from = time_from_ns(*after) + Duration(1);
  }
  while (times.size() < count) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline.at_or_after(from));
    if (!entry) break;
    times.push_back(to_ns(entry->time));
    if (entry->time == Time::max()) break;
    from = entry->time + Duration(1);
  }
  return times;
}

}  // namespace

OpenStore::OpenStore(const std::filesystem::path& path) {
  auto reader = [&] {
    const py::gil_scoped_release released;
    return ltm::StoreReader::open(path);
  }();
  recall_ = std::make_unique<ltm::Recall>(value_or_raise(std::move(reader)), encoders::load_model,
                                          nullptr, server::make_entity_forecaster);
}

/// Calls `work`, which gives a Result, without the GIL.
template <typename F>
auto OpenStore::with_recall(F work) {
  auto result = [&]() -> decltype(work(*recall_)) {
    const py::gil_scoped_release released;
    const std::scoped_lock lock(mutex_);
    if (recall_ == nullptr) return failed_precondition("the memory is closed");
    return work(*recall_);
  }();
  return value_or_raise(std::move(result));
}

std::vector<std::string> OpenStore::entities() {
  return with_recall([](ltm::Recall& recall) -> Result<std::vector<std::string>> {
    std::vector<std::string> names;
    for (const ltm::MemoryId& entity : recall.store().entities())
      names.push_back(entity.to_string());
    return names;
  });
}

py::dict OpenStore::summary(const std::string& entity) {
  const auto found = with_recall([&](ltm::Recall& recall) -> Result<ltm::EntitySummary> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    return recall.store().summary(id);
  });
  py::list models;
  for (const ltm::ModelInfo& model : found.models) models.append(model.version);
  py::dict dict;
  dict["snapshots"] = found.snapshots;
  dict["first"] = to_ns(found.first);
  dict["last"] = to_ns(found.last);
  dict["raw_bytes"] = found.raw_bytes;
  dict["stored_bytes"] = found.stored_bytes;
  dict["latent_bytes"] = found.latent_bytes;
  dict["model_bytes"] = found.model_bytes;
  dict["models"] = std::move(models);
  return dict;
}

std::vector<int64_t> OpenStore::times(const std::string& entity, std::optional<int64_t> after,
                                      size_t count) {
  return with_recall([&](ltm::Recall& recall) -> Result<std::vector<int64_t>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, recall.store().timeline(id));
    return times_behind(*timeline, after, count);
  });
}

py::list OpenStore::select(const std::string& entity, const std::string& selector,
                           bool prefers_latents) {
  const auto result = with_recall([&](ltm::Recall& recall) -> Result<ltm::QueryResult> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Selector parsed, ltm::parse_selector(selector));
    ENGRAM_RETURN_IF_ERROR(ltm::validate(parsed));
    return recall.query(ltm::Query::of_entity(id, parsed), options_of(prefers_latents));
  });
  py::list snapshots;
  for (const ltm::EntityResult* found : result.entities()) snapshots = snapshots_of(*found);
  return snapshots;
}

py::list OpenStore::query(const std::string& text, bool prefers_latents) {
  const auto result = with_recall([&](ltm::Recall& recall) -> Result<ltm::QueryResult> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
    return recall.query(query, options_of(prefers_latents));
  });
  py::list answer;
  for (const ltm::EntityResult* found : result.entities())
    answer.append(py::make_tuple(found->id.to_string(), snapshots_of(*found)));
  return answer;
}

void OpenStore::close() {
  const py::gil_scoped_release released;
  const std::scoped_lock lock(mutex_);
  recall_.reset();
}

}  // namespace engram::python
