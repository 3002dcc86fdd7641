// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/open_store.h"

#include <pybind11/stl.h>
#include <unistd.h>

#include <cmath>

#include "encoders/load_model.h"
#include "ltm/prediction/entity_predictor.h"
#include "ltm/saliency/why_salient.h"
#include "python/bindings/bound_commit.h"
#include "python/bindings/errors.h"
#include "python/bindings/query_result.h"
#include "python/bindings/values.h"
#include "training/measure/stored_snapshots.h"

namespace engram::python {

namespace {

namespace py = pybind11;

ltm::Recall::Options options_of(bool prefers_latents, const std::string& engine = {}) {
  ltm::Recall::Options options;
  if (prefers_latents) options.prefer = ltm::Prefer::kLatent;
  options.engine = engine;
  return options;
}

Result<std::vector<int64_t>> times_behind(ltm::Timeline& timeline, std::optional<int64_t> after,
                                          size_t count) {
  std::vector<int64_t> times;
  Time from = Time::min();
  if (after) {
    // Nothing can follow the last time that exists, and adding to it would overflow.
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

Result<std::unique_ptr<ltm::Recall>> open_recall(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(path));
  return std::make_unique<ltm::Recall>(std::move(reader), encoders::load_model, nullptr,
                                       ltm::make_entity_predictor);
}

/// The columns of stored_snapshots().
struct StoredColumns {
  std::vector<int64_t> times, models;
  std::vector<std::string> forms;
  std::vector<double> bytes, psnr_db, rmse;
};

StoredColumns columns_of(const std::vector<training::StoredSnapshot>& snapshots) {
  StoredColumns columns;
  for (const training::StoredSnapshot& one : snapshots) {
    columns.times.push_back(to_ns(one.time));
    columns.models.push_back(one.model_version);
    std::vector<std::string> forms;
    for (const training::StoredImage& image : one.images) forms.emplace_back(to_string(image.form));
    columns.forms.push_back(fmt::format("{}", fmt::join(forms, "+")));
    columns.bytes.push_back(one.bytes);
    columns.psnr_db.push_back(one.psnr_db);
    columns.rmse.push_back(one.rmse);
  }
  return columns;
}

/// Times and latents of one model, of the first instance of each snapshot.
struct FoundLatents {
  std::vector<int64_t> times;
  std::vector<ltm::Latent> latents;
};

Result<FoundLatents> read_latents(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                  int version, Time first, Time last) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader.index(entity));
  FoundLatents found;
  for (const ltm::SnapshotEntry& entry : *index) {
    if (!entry.latent || entry.time < first || entry.time > last) continue;
    ENGRAM_ASSIGN_OR_RETURN(ltm::LatentSnapshot snapshot, reader.read_latent(entity, entry));
    if (snapshot.model_version != version || snapshot.instances.empty()) continue;
    found.times.push_back(to_ns(entry.time));
    found.latents.push_back(std::move(snapshot.instances.front().latent));
  }
  return found;
}

}  // namespace

OpenStore::OpenStore(const std::filesystem::path& path) : path_(path), process_(::getpid()) {
  auto opened = [&] {
    const py::gil_scoped_release released;
    return open_recall(path_);
  }();
  recall_ = value_or_raise(std::move(opened));
}

/// Calls `work`, which returns a Result, without the GIL.
template <typename F>
auto OpenStore::with_recall(F work) {
  auto result = [&]() -> decltype(work(*recall_)) {
    const py::gil_scoped_release released;
    // Before the lock: a thread that held it when this process was forked is not in this one.
    if (process_ != ::getpid())
      return failed_precondition("the memory was opened by another process: open it in this one");
    const MutexLock lock(mutex_);
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

std::pair<int64_t, int64_t> OpenStore::span(const std::string& entity) {
  return with_recall([&](ltm::Recall& recall) -> Result<std::pair<int64_t, int64_t>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::EntitySummary found, recall.store().summary(id));
    return std::pair{to_ns(found.first), to_ns(found.last)};
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

std::vector<int64_t> OpenStore::selected_times(const std::string& entity,
                                               const std::string& selectors) {
  return with_recall([&](ltm::Recall& recall) -> Result<std::vector<int64_t>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query ids, ltm::Query::of_entity(id, selectors, true));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult answer, recall.query(ids));
    return times_in(answer, id);
  });
}

py::list OpenStore::select(const std::string& entity, const std::string& selector,
                           bool prefers_latents) {
  const auto result = with_recall([&](ltm::Recall& recall) -> Result<ltm::QueryResult> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::of_entity(id, selector));
    return recall.query(query, options_of(prefers_latents));
  });
  py::list snapshots;
  for (const ltm::EntityResult* found : result.entities())
    snapshots = snapshots_of(found->id, found->snapshots);
  return snapshots;
}

py::list OpenStore::query(const std::string& text, bool prefers_latents,
                          const std::string& engine) {
  return answer_of(with_recall([&](ltm::Recall& recall) -> Result<ltm::QueryResult> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
    return recall.query(query, options_of(prefers_latents, engine));
  }));
}

py::list OpenStore::predict(const std::string& entity, const std::vector<int64_t>& horizons,
                            std::optional<int64_t> from, const std::string& engine,
                            const std::string& plan, bool prefers_latents) {
  ltm::PredictionRequest request;
  if (from) request.from = time_from_ns(*from);
  for (const int64_t horizon : horizons) request.horizons.emplace_back(horizon);
  request.engine = engine;
  if (!plan.empty()) request.plan = value_or_raise(entity_of(plan));
  const auto id = value_or_raise(entity_of(entity));
  return snapshots_of(id, with_recall([&](ltm::Recall& recall) {
                        return recall.predict(id, request, options_of(prefers_latents));
                      }));
}

py::list OpenStore::engines(const std::string& entity, int64_t ahead, std::optional<int64_t> from,
                            bool prefers_latents) {
  return engines_of(with_recall([&](ltm::Recall& recall) -> Result<std::vector<ltm::EngineRecord>> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    std::optional<Time> time;
    if (from) time = time_from_ns(*from);
    return recall.records(id, time, Duration(ahead), options_of(prefers_latents));
  }));
}

py::dict OpenStore::similar(const SimilarArguments& asked) {
  const ltm::SimilarRequest request = similar_request_of(asked);
  return similar_of(
      with_recall([&](ltm::Recall&) ENGRAM_REQUIRES(mutex_) -> Result<ltm::SimilarAnswer> {
        ENGRAM_RETURN_IF_ERROR(open_likeness());
        return likeness_->find(request);
      }));
}

py::dict OpenStore::map(const std::string& entity, size_t max_moments) {
  const ltm::MemoryId id = value_or_raise(entity_of(entity));
  return map_of(with_recall([&](ltm::Recall&) ENGRAM_REQUIRES(mutex_) -> Result<ltm::MomentMap> {
    ENGRAM_RETURN_IF_ERROR(open_likeness());
    return likeness_->map(id, max_moments);
  }));
}

Status OpenStore::open_likeness() {
  if (likeness_ != nullptr) return {};
  ENGRAM_ASSIGN_OR_RETURN(past_, ltm::StorePast::open(path_, encoders::load_model, {}));
  likeness_ = std::make_unique<ltm::LikenessSearch>(*past_);
  return {};
}

py::dict OpenStore::why_salient(const std::string& entity, std::optional<int64_t> moment) {
  const ltm::MemoryId id = value_or_raise(entity_of(entity));
  std::optional<Time> time;
  if (moment) time = time_from_ns(*moment);
  const auto told = with_recall(
      [&](ltm::Recall&) { return ltm::why_salient(path_, encoders::load_model, id, time); });
  py::list parts;
  for (const ltm::SalientPart& one : told.parts) {
    py::dict part;
    part["part"] = std::string(ltm::name_of(one.part));
    part["value"] = one.value;
    part["weight"] = one.weight;
    part["contribution"] = one.contribution;
    part["found"] = one.found;
    part["expected"] = one.expected;
    parts.append(std::move(part));
  }
  py::dict found;
  found["time"] = to_ns(told.time);
  found["saliency"] = told.saliency;
  found["rank"] = told.rank;
  found["count"] = told.count;
  found["is_stored"] = told.is_stored;
  found["learned_from"] = told.learned_from;
  found["parts"] = std::move(parts);
  return found;
}

py::list OpenStore::models() {
  const auto found = with_recall([](ltm::Recall& recall) -> Result<std::vector<ltm::ModelInfo>> {
    return recall.store().manifest().models;
  });
  py::list models;
  for (const ltm::ModelInfo& one : found) {
    py::dict model;
    model["entity"] = one.entity.to_string();
    model["version"] = one.version;
    model["file"] = (path_ / one.file).string();
    model["bytes"] = one.bytes;
    models.append(std::move(model));
  }
  return models;
}

py::dict OpenStore::stored_snapshots(const std::string& entity) {
  const StoredColumns found = with_recall([&](ltm::Recall& recall) -> Result<StoredColumns> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    std::vector<training::StoredSnapshot> snapshots;
    ENGRAM_RETURN_IF_ERROR(training::list_stored_snapshots(
        recall.store(), id, [&](const training::StoredSnapshot& one) -> Status {
          snapshots.push_back(one);
          return {};
        }));
    return columns_of(snapshots);
  });
  py::dict columns;
  columns["time"] = py::array_t<int64_t>(py::cast(found.times));
  columns["model"] = py::array_t<int64_t>(py::cast(found.models));
  columns["form"] = py::cast(found.forms);
  columns["bytes"] = py::array_t<double>(py::cast(found.bytes));
  columns["psnr_db"] = py::array_t<double>(py::cast(found.psnr_db));
  columns["rmse"] = py::array_t<double>(py::cast(found.rmse));
  return columns;
}

py::dict OpenStore::latents(const std::string& entity, int version, int64_t first, int64_t last,
                            InspectedModel& model) {
  const FoundLatents found = with_recall([&](ltm::Recall& recall) -> Result<FoundLatents> {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, entity_of(entity));
    return read_latents(recall.store(), id, version, time_from_ns(first), time_from_ns(last));
  });
  py::dict latents = model.stored(found.latents);
  latents["times"] = py::array_t<int64_t>(py::cast(found.times));
  return latents;
}

void OpenStore::refresh() {
  with_recall([&](ltm::Recall&) ENGRAM_REQUIRES(mutex_) -> Result<bool> {
    ENGRAM_ASSIGN_OR_RETURN(recall_, open_recall(path_));
    likeness_.reset();
    past_.reset();
    return true;
  });
}

void OpenStore::close() {
  const py::gil_scoped_release released;
  const MutexLock lock(mutex_);
  likeness_.reset();
  past_.reset();
  recall_.reset();
}

}  // namespace engram::python
