// SPDX-License-Identifier: Apache-2.0
// Moments, past and future, and what leads from one to others.
#include <algorithm>
#include <cmath>

#include "ltm/core/not_a_number.h"
#include "ltm/memory/links.h"
#include "reports/plain/save.h"
#include "reports/plain/shown_value.h"
#include "viewer/view_answers.h"

namespace engram::viewer {

namespace {

using MomentJson = nlohmann::ordered_json;

constexpr size_t kMaxHorizons = 64;
/// Links to a moment, of all entities.
constexpr size_t kMaxBacklinks = 1000;

MomentJson metadata_json(const ltm::InstanceMetadata& metadata) {
  MomentJson json{{"created", time_text(metadata.created)},
                  {"sent", time_text(metadata.sent)},
                  {"arrived", time_text(metadata.arrived)},
                  {"provider", metadata.provider},
                  {"confidence", metadata.confidence}};
  if (metadata.origin.depth() > 0) json["origin"] = metadata.origin.to_string();
  if (!metadata.recipe.empty()) json["recipe"] = metadata.recipe;
  return json;
}

void write_error(MomentJson& json, const char* name, double number) {
  if (std::isfinite(number)) json[name] = number;
}

/// Errors as numbers, and in the words of `engram query --json`.
void write_errors(MomentJson& json, const ltm::InstanceResult& instance) {
  if (instance.error) {
    write_error(json, "expected_error", error_number(*instance.error));
    json["error"] = reports::error_json(*instance.error);
  }
  if (instance.bound) {
    write_error(json, "bound", error_number(*instance.bound));
    json["error_bound"] = reports::error_json(*instance.bound);
  }
}

MomentJson members_json(const std::vector<ltm::MemberPrediction>& members) {
  MomentJson list = MomentJson::array();
  for (const ltm::MemberPrediction& member : members) {
    const auto number_of = [&member](double mse) {
      return error_number(member.is_image ? ltm::MeasuredError{mse}
                                          : ltm::MeasuredError{kNaN, mse});
    };
    MomentJson json{{"path", member.path}, {"engine", member.engine}};
    write_error(json, "expected_error", number_of(member.expected_mse));
    write_error(json, "bound", number_of(member.bound_mse));
    list.push_back(std::move(json));
  }
  return list;
}

Result<MomentJson> instance_json(const ltm::InstanceResult& instance,
                                 const std::optional<idf::Type>& type) {
  MomentJson json{{"index", instance.index}, {"metadata", metadata_json(instance.metadata)}};
  write_errors(json, instance);
  ENGRAM_ASSIGN_OR_RETURN(json["data"], reports::shown_value(instance.data, type));
  return json;
}

/// A snapshot as the inspector shows it. Its errors are those of its first instance that has any.
Result<MomentJson> moment_json(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot,
                               const std::optional<idf::Type>& type) {
  MomentJson json{{"id", entity.at(snapshot.time).to_string()},
                  {"time", time_text(snapshot.time)},
                  {"source", ltm::to_string(snapshot.source)}};
  if (!snapshot.model.empty()) json["model"] = snapshot.model;
  if (!snapshot.predictor.empty()) {
    json["engine"] = snapshot.predictor;
    json["horizon"] = std::to_string(snapshot.horizon.count());
    json["from"] = time_text(snapshot.time - snapshot.horizon);
  }
  const auto measured = std::ranges::find_if(
      snapshot.instances, [](const ltm::InstanceResult& one) { return one.error.has_value(); });
  if (measured != snapshot.instances.end()) {
    write_errors(json, *measured);
    if (!measured->members.empty()) json["members"] = members_json(measured->members);
  }
  json["instances"] = MomentJson::array();
  for (const ltm::InstanceResult& instance : snapshot.instances) {
    ENGRAM_ASSIGN_OR_RETURN(MomentJson one, instance_json(instance, type));
    json["instances"].push_back(std::move(one));
  }
  return json;
}

Result<MomentJson> neighbour_json(ViewedMemory& viewed, const ltm::MemoryId& entity,
                                  const ltm::Selector& selector) {
  ENGRAM_ASSIGN_OR_RETURN(const auto found, find_one(viewed.memory(), entity, selector, true));
  return found ? MomentJson(time_text(found->time)) : MomentJson();
}

/// Adds an answer to a query as `engram query --json` prints it, and counts its bytes.
Status add_part(const ltm::QueryResult& part, bool is_ids_only, MomentJson& list, size_t& bytes) {
  if (is_ids_only) {
    for (const ltm::MemoryId& id : part.ids()) {
      bytes += list.emplace_back(id.to_string()).get_ref<const std::string&>().size();
    }
  } else {
    for (const ltm::EntityResult* entity : part.entities()) {
      const std::string id = entity->id.to_string();
      if (list.empty() || list.back()["id"] != id)
        list.push_back({{"id", id}, {"snapshots", MomentJson::array()}});
      for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
        ENGRAM_ASSIGN_OR_RETURN(MomentJson json, reports::snapshot_json(entity->id, snapshot));
        // Written twice, so that what is too large is noticed before all of it is there.
        bytes += json_text(json).size();
        list.back()["snapshots"].push_back(std::move(json));
        if (bytes > kMaxAnswerBytes) break;
      }
    }
  }
  if (bytes > kMaxAnswerBytes)
    return resource_exhausted(
        "the answer has more than {} bytes: ask for less, or use 'engram "
        "query --json'",
        kMaxAnswerBytes);
  return {};
}

}  // namespace

ViewAnswer answer_moment(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const Time at, target.time("at"));
  ENGRAM_ASSIGN_OR_RETURN(
      const std::string which,
      target.choice("which", {"at-or-before", "nearest", "exact", "predict"}, "at-or-before"));
  ltm::Selector selector = ltm::select::At{at};
  if (which == "at-or-before") selector = ltm::select::Before{at, true};
  if (which == "nearest") selector = ltm::select::Nearest{at};
  Memory* memory = &viewed.memory();
  if (which == "predict") {
    ENGRAM_ASSIGN_OR_RETURN(memory, viewed.for_long_questions());
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto found, find_one(*memory, entity, selector));
  if (!found || (which == "exact" && found->source == ltm::Source::kPredicted))
    return not_found("'{}': has no snapshot for '{}' of {}", entity.to_string(), which,
                     to_string(at));
  ENGRAM_ASSIGN_OR_RETURN(MomentJson json, moment_json(entity, *found, viewed.type_of(entity)));
  ENGRAM_ASSIGN_OR_RETURN(json["previous"],
                          neighbour_json(viewed, entity, ltm::select::Before{found->time, false}));
  ENGRAM_ASSIGN_OR_RETURN(json["next"],
                          neighbour_json(viewed, entity, ltm::select::After{found->time}));
  return bounded_json(json);
}

ViewAnswer answer_step(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxStep = 1'000'000;
  // Each step of a server is a question of its own.
  constexpr int64_t kMaxAskedStep = 100;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const Time at, target.time("at"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t by, target.integer("by", -kMaxStep, kMaxStep));
  if (by == 0) return invalid_argument("parameter 'by': found 0, needs another number");
  Time there = at;
  if (viewed.is_store()) {
    ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, entity));
      const std::vector<Time>& all = times->all;
      if (all.empty()) return not_found("'{}': has no snapshots", entity.to_string());
      const auto next =
          by > 0 ? std::ranges::upper_bound(all, at) : std::ranges::lower_bound(all, at);
      const int64_t index = next - all.begin() + (by > 0 ? by - 1 : by);
      there = all[static_cast<size_t>(
          std::clamp<int64_t>(index, 0, static_cast<int64_t>(all.size()) - 1))];
      return {};
    }));
    return json_response({{"time", time_text(there)}});
  }
  for (int64_t i = 0; i < std::min(std::abs(by), kMaxAskedStep); ++i) {
    const ltm::Selector selector = by > 0 ? ltm::Selector(ltm::select::After{there})
                                          : ltm::Selector(ltm::select::Before{there, false});
    ENGRAM_ASSIGN_OR_RETURN(const auto found, find_one(viewed.memory(), entity, selector, true));
    if (!found) break;
    there = found->time;
  }
  return json_response({{"time", time_text(there)}});
}

ViewAnswer answer_predict(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId entity, target.entity("entity"));
  ENGRAM_ASSIGN_OR_RETURN(const auto ahead_ns,
                          target.integers("horizon", 1, Duration::max().count(), kMaxHorizons));
  std::vector<Duration> horizons;
  for (const int64_t ns : ahead_ns) horizons.emplace_back(ns);
  PredictOptions options;
  if (target.find("at")) {
    ENGRAM_ASSIGN_OR_RETURN(options.at, target.time("at"));
  }
  ENGRAM_ASSIGN_OR_RETURN(Memory * memory, viewed.for_long_questions());
  ENGRAM_ASSIGN_OR_RETURN(const auto found, memory->predict(entity, horizons, options));
  const auto type = viewed.type_of(entity);
  MomentJson list = MomentJson::array();
  for (const ltm::SnapshotResult& snapshot : found) {
    ENGRAM_ASSIGN_OR_RETURN(MomentJson json, moment_json(entity, snapshot, type));
    list.push_back(std::move(json));
  }
  return bounded_json(list);
}

ViewAnswer answer_query(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, target.text("q"));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::parse(text));
  MomentJson list = MomentJson::array();
  size_t bytes = 0;
  ENGRAM_ASSIGN_OR_RETURN(Memory * memory, viewed.for_long_questions());
  ENGRAM_RETURN_IF_ERROR(memory->query_parts(query, [&](const ltm::QueryResult& part) {
    return add_part(part, query.is_ids_only(), list, bytes);
  }));
  return json_response({{query.is_ids_only() ? "ids" : "entities", std::move(list)}});
}

ViewAnswer answer_similar(ViewedMemory& viewed, const RequestTarget& target) {
  constexpr int64_t kMaxSimilar = 1000;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, target.moment("id"));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t count, target.integer("k", 1, kMaxSimilar, 10));
  ENGRAM_ASSIGN_OR_RETURN(const std::string one_per, target.choice("one_per", {"recording"}, ""));
  // Likeness has a lock of its own: neither moments nor predictions wait for it.
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::SimilarAnswer found,
      viewed.memory().similar({.entity = id.entity(),
                               .moment = id.time(),
                               .count = static_cast<size_t>(count),
                               .is_one_per_recording = one_per == "recording"}));
  MomentJson list = MomentJson::array();
  for (const ltm::SimilarMoment& moment : found.moments)
    list.push_back({{"id", found.entity.at(moment.time).to_string()},
                    {"time", time_text(moment.time)},
                    {"distance", moment.distance},
                    {"recording",
                     {{"first", time_text(moment.recording_first)},
                      {"last", time_text(moment.recording_last)}}}});
  return json_response(
      {{"found", std::move(list)}, {"space", found.space}, {"compared", found.compared}});
}

ViewAnswer answer_links(ViewedMemory& viewed, const RequestTarget& target) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id, target.moment("id"));
  const ltm::MemoryId snapshot = id.entity().at(*id.time());
  ENGRAM_ASSIGN_OR_RETURN(const auto found,
                          find_one(viewed.memory(), id.entity(), ltm::select::At{*id.time()}));
  if (!found || found->source == ltm::Source::kPredicted)
    return not_found("'{}': there is no such snapshot", snapshot.to_string());
  const auto type = viewed.type_of(id.entity());
  MomentJson to = MomentJson::array();
  for (const ltm::InstanceResult& instance : found->instances) {
    const auto links =
        type ? ltm::find_links(instance.data, *type) : ltm::find_links(instance.data);
    for (const ltm::Link& link : links)
      to.push_back(
          {{"path", link.path}, {"id", link.id.to_string()}, {"instance", instance.index}});
  }
  const ltm::Condition is_linked{ltm::where::LinkedTo{snapshot}};
  const ltm::EntityQuery any{{}, {{ltm::select::All{}, {}, {is_linked}}}};
  const ltm::MemoryQuery all{{},
                             {ltm::CoreSegmentQuery{{}, {ltm::ProviderSegmentQuery{{}, {any}}}}}};
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query query, ltm::Query::create({all}, true));
  MomentJson from = MomentJson::array();
  bool has_more = false;
  ENGRAM_RETURN_IF_ERROR(viewed.memory().query_parts(query, [&](const ltm::QueryResult& part) {
    for (const ltm::EntityResult* entity : part.entities())
      for (const ltm::SnapshotResult& one : entity->snapshots) {
        has_more = from.size() >= kMaxBacklinks;
        if (!has_more) from.push_back(entity->id.at(one.time).to_string());
      }
    return Status();
  }));
  return bounded_json({{"to", std::move(to)}, {"from", std::move(from)}, {"more", has_more}});
}

}  // namespace engram::viewer
