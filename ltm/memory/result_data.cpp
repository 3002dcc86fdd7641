// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/data_fields.h"
#include "ltm/memory/result.h"

namespace engram::ltm {

namespace {

idf::Data error_data(const MeasuredError& error) {
  return idf::Dict{{"image_mse", error.image_mse}, {"number_mse", error.number_mse}};
}

idf::Data members_data(const std::vector<MemberPrediction>& members) {
  idf::List list;
  for (const MemberPrediction& member : members)
    list.push_back(idf::Dict{{"path", member.path},
                             {"engine", member.engine},
                             {"expected_mse", member.expected_mse},
                             {"bound_mse", member.bound_mse},
                             {"copied", member.copied},
                             {"is_image", member.is_image},
                             {"is_moving", member.is_moving},
                             {"is_counted", member.is_counted}});
  return list;
}

idf::Data instance_data(const InstanceResult& instance, bool is_ids_only) {
  idf::Dict dict{{"index", instance.index}};
  if (is_ids_only) return dict;
  dict.set("data", instance.data);
  dict.set("metadata", instance.metadata.to_data());
  if (instance.error) dict.set("error", error_data(*instance.error));
  if (instance.bound) dict.set("bound", error_data(*instance.bound));
  if (!instance.members.empty()) dict.set("members", members_data(instance.members));
  return dict;
}

idf::Data snapshot_data(const SnapshotResult& snapshot, bool is_ids_only) {
  idf::Dict dict{{"time", to_ns(snapshot.time)}, {"source", to_string(snapshot.source)}};
  if (!snapshot.model.empty()) dict.set("model", snapshot.model);
  if (!snapshot.predictor.empty()) dict.set("predictor", snapshot.predictor);
  if (snapshot.horizon != Duration(0)) dict.set("horizon", int64_t{snapshot.horizon.count()});
  if (!snapshot.plan.empty()) dict.set("plan", snapshot.plan);
  idf::List instances;
  instances.reserve(snapshot.instances.size());
  for (const InstanceResult& instance : snapshot.instances)
    instances.push_back(instance_data(instance, is_ids_only));
  dict.set("instances", std::move(instances));
  return dict;
}

idf::Data entity_data(const EntityResult& entity, bool is_ids_only) {
  idf::List snapshots;
  snapshots.reserve(entity.snapshots.size());
  for (const SnapshotResult& snapshot : entity.snapshots)
    snapshots.push_back(snapshot_data(snapshot, is_ids_only));
  return idf::Dict{{"id", entity.id.to_data()}, {"snapshots", std::move(snapshots)}};
}

/// Returns nothing where there is no member `name`.
Result<std::optional<MeasuredError>> error_from(const DataFields& instance, const char* name) {
  if (!instance.has(name)) return std::optional<MeasuredError>();
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* data, instance.data(name));
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(*data, name));
  MeasuredError error;
  ENGRAM_ASSIGN_OR_RETURN(error.image_mse, fields.number("image_mse"));
  ENGRAM_ASSIGN_OR_RETURN(error.number_mse, fields.number("number_mse"));
  return std::optional(error);
}

Result<MemberPrediction> member_from(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "member"));
  MemberPrediction member;
  ENGRAM_ASSIGN_OR_RETURN(member.path, fields.text("path"));
  ENGRAM_ASSIGN_OR_RETURN(member.engine, fields.text("engine"));
  ENGRAM_ASSIGN_OR_RETURN(member.expected_mse, fields.number("expected_mse"));
  ENGRAM_ASSIGN_OR_RETURN(member.bound_mse, fields.number("bound_mse"));
  ENGRAM_ASSIGN_OR_RETURN(member.copied, fields.number("copied"));
  ENGRAM_ASSIGN_OR_RETURN(member.is_image, fields.boolean("is_image"));
  ENGRAM_ASSIGN_OR_RETURN(member.is_moving, fields.boolean("is_moving"));
  // Answers of earlier versions do not tell it.
  if (fields.has("is_counted")) {
    ENGRAM_ASSIGN_OR_RETURN(member.is_counted, fields.boolean("is_counted"));
  }
  return member;
}

Result<InstanceResult> instance_from(const idf::Data& data, bool is_ids_only) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "instance"));
  InstanceResult instance;
  ENGRAM_ASSIGN_OR_RETURN(instance.index, fields.instance_index("index"));
  if (is_ids_only) return instance;
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* value, fields.data("data"));
  instance.data = *value;
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* metadata, fields.data("metadata"));
  ENGRAM_ASSIGN_OR_RETURN(instance.metadata, InstanceMetadata::from_data(*metadata));
  ENGRAM_ASSIGN_OR_RETURN(instance.error, error_from(fields, "error"));
  ENGRAM_ASSIGN_OR_RETURN(instance.bound, error_from(fields, "bound"));
  if (fields.has("members")) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::List* members, fields.list("members"));
    for (const idf::Data& one : *members) {
      ENGRAM_ASSIGN_OR_RETURN(instance.members.emplace_back(), member_from(one));
    }
  }
  return instance;
}

Status read_instances(const idf::List& list, bool is_ids_only, SnapshotResult& snapshot) {
  for (const idf::Data& one : list) {
    ENGRAM_ASSIGN_OR_RETURN(InstanceResult instance, instance_from(one, is_ids_only));
    if (!snapshot.instances.empty() && instance.index <= snapshot.instances.back().index)
      return invalid_argument("snapshot: instance {} comes after {}, needs increasing indices",
                              instance.index, snapshot.instances.back().index);
    snapshot.instances.push_back(std::move(instance));
  }
  return {};
}

Result<SnapshotResult> snapshot_from(const idf::Data& data, bool is_ids_only) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "snapshot"));
  SnapshotResult snapshot;
  ENGRAM_ASSIGN_OR_RETURN(snapshot.time, fields.time("time"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string name, fields.text("source"));
  const auto source = source_from_name(name);
  if (!source) return invalid_argument("snapshot: source '{}' is not known", name);
  snapshot.source = *source;
  if (fields.has("model")) {
    ENGRAM_ASSIGN_OR_RETURN(snapshot.model, fields.text("model"));
  }
  if (fields.has("predictor")) {
    ENGRAM_ASSIGN_OR_RETURN(snapshot.predictor, fields.text("predictor"));
  }
  if (fields.has("horizon")) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t horizon, fields.integer("horizon"));
    snapshot.horizon = Duration(horizon);
  }
  if (fields.has("plan")) {
    ENGRAM_ASSIGN_OR_RETURN(snapshot.plan, fields.text("plan"));
  }
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* instances, fields.list("instances"));
  ENGRAM_RETURN_IF_ERROR(read_instances(*instances, is_ids_only, snapshot));
  return snapshot;
}

/// Reads one entity, which must come after `last` in the order of names, and stores it in `last`.
Status read_entity(const idf::Data& data, QueryResult& result, MemoryId& last) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "entity"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* id, fields.data("id"));
  ENGRAM_ASSIGN_OR_RETURN(const MemoryId entity, MemoryId::from_data(*id));
  if (!entity.is_entity())
    return invalid_argument("'{}' is no entity: needs four names", entity.to_string());
  // A strict order excludes duplicates and appends in O(1), also where the data are hostile.
  if (entity <= last)
    return invalid_argument("'{}' comes after '{}', needs increasing names", entity.to_string(),
                            last.to_string());
  last = entity;
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* snapshots, fields.list("snapshots"));
  EntityResult& place = result.add_entity(entity);
  for (const idf::Data& one : *snapshots) {
    ENGRAM_ASSIGN_OR_RETURN(SnapshotResult snapshot, snapshot_from(one, result.is_ids_only()));
    if (!place.snapshots.empty() && snapshot.time <= place.snapshots.back().time)
      return invalid_argument("'{}': {} comes after {}, needs increasing times", entity.to_string(),
                              to_string(snapshot.time), to_string(place.snapshots.back().time));
    place.snapshots.push_back(std::move(snapshot));
  }
  return {};
}

}  // namespace

idf::Data QueryResult::to_data() const {
  idf::List list;
  for (const EntityResult* entity : entities()) list.push_back(entity_data(*entity, is_ids_only_));
  return idf::Dict{{"ids_only", is_ids_only_}, {"entities", std::move(list)}};
}

Result<QueryResult> QueryResult::from_data(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "result"));
  ENGRAM_ASSIGN_OR_RETURN(const bool is_ids_only, fields.boolean("ids_only"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* list, fields.list("entities"));
  QueryResult result(is_ids_only);
  MemoryId last;
  for (const idf::Data& one : *list)
    if (const Status read = read_entity(one, result, last); !read.ok())
      return read.with_context("result");
  return result;
}

}  // namespace engram::ltm
