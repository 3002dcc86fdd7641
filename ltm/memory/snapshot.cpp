// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot.h"

#include <algorithm>

#include "ltm/idf/binary.h"
#include "ltm/memory/data_fields.h"

namespace engram::ltm {

namespace {

Result<Instance> instance_from(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "instance"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* value, fields.data("data"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* metadata, fields.data("metadata"));
  ENGRAM_ASSIGN_OR_RETURN(InstanceMetadata read, InstanceMetadata::from_data(*metadata));
  return Instance{*value, std::move(read)};
}

}  // namespace

idf::Data InstanceMetadata::to_data() const {
  idf::Dict dict{{"created", to_ns(created)},
                 {"sent", to_ns(sent)},
                 {"arrived", to_ns(arrived)},
                 {"provider", provider},
                 {"confidence", confidence}};
  if (origin.depth() > 0) dict.set("origin", origin.to_data());
  if (!recipe.empty()) dict.set("recipe", recipe);
  return dict;
}

Result<InstanceMetadata> InstanceMetadata::from_data(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "metadata"));
  InstanceMetadata metadata;
  ENGRAM_ASSIGN_OR_RETURN(metadata.created, fields.time("created"));
  ENGRAM_ASSIGN_OR_RETURN(metadata.sent, fields.time("sent"));
  ENGRAM_ASSIGN_OR_RETURN(metadata.arrived, fields.time("arrived"));
  ENGRAM_ASSIGN_OR_RETURN(metadata.provider, fields.text("provider"));
  ENGRAM_ASSIGN_OR_RETURN(const double confidence, fields.number("confidence"));
  if (!(confidence >= 0 && confidence <= 1))
    return invalid_argument("metadata: confidence is {}, needs 0 to 1", confidence);
  metadata.confidence = static_cast<float>(confidence);
  if (fields.has("origin")) {
    ENGRAM_ASSIGN_OR_RETURN(const idf::Data* origin, fields.data("origin"));
    auto id = MemoryId::from_data(*origin);
    if (!id.ok()) return id.status().with_context("metadata: origin");
    metadata.origin = *std::move(id);
  }
  if (fields.has("recipe")) {
    ENGRAM_ASSIGN_OR_RETURN(metadata.recipe, fields.text("recipe"));
  }
  return metadata;
}

bool Snapshot::is_augmented() const {
  return std::ranges::any_of(
      instances, [](const Instance& instance) { return instance.metadata.is_augmented(); });
}

size_t Snapshot::raw_bytes() const {
  size_t total = 0;
  for (const Instance& instance : instances) total += idf::encoded_size(instance.data);
  return total;
}

idf::Data Snapshot::to_data() const {
  idf::List list;
  list.reserve(instances.size());
  for (const Instance& instance : instances)
    list.emplace_back(
        idf::Dict{{"data", instance.data}, {"metadata", instance.metadata.to_data()}});
  return idf::Dict{
      {"entity", entity.to_data()}, {"time", to_ns(time)}, {"instances", std::move(list)}};
}

Result<Snapshot> Snapshot::from_data(const idf::Data& data) {
  ENGRAM_ASSIGN_OR_RETURN(const DataFields fields, DataFields::of(data, "snapshot"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data* entity, fields.data("entity"));
  Snapshot snapshot;
  ENGRAM_ASSIGN_OR_RETURN(snapshot.entity, MemoryId::from_data(*entity));
  if (!snapshot.entity.is_entity())
    return invalid_argument("snapshot: '{}' is no entity: needs four names",
                            snapshot.entity.to_string());
  ENGRAM_ASSIGN_OR_RETURN(snapshot.time, fields.time("time"));
  ENGRAM_ASSIGN_OR_RETURN(const idf::List* instances, fields.list("instances"));
  snapshot.instances.reserve(instances->size());
  for (const idf::Data& one : *instances) {
    ENGRAM_ASSIGN_OR_RETURN(Instance instance, instance_from(one));
    snapshot.instances.push_back(std::move(instance));
  }
  return snapshot;
}

}  // namespace engram::ltm
