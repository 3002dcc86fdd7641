// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/query_result.h"

#include <cmath>

#include "python/bindings/measured_error.h"
#include "python/bindings/values.h"

namespace engram::python {

namespace {

namespace py = pybind11;

py::object number_or_none(double number) {
  return std::isnan(number) ? py::object(py::none()) : py::object(py::float_(number));
}

py::list members_of(const std::vector<ltm::MemberPrediction>& members) {
  py::list list;
  for (const ltm::MemberPrediction& member : members) {
    py::dict dict;
    dict["path"] = member.path;
    dict["engine"] = member.engine;
    dict["expected_mse"] = number_or_none(member.expected_mse);
    dict["bound_mse"] = number_or_none(member.bound_mse);
    dict["copied"] = member.copied;
    dict["is_image"] = member.is_image;
    dict["is_moving"] = member.is_moving;
    dict["is_counted"] = member.is_counted;
    list.append(std::move(dict));
  }
  return list;
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
  dict["error"] = to_python(instance.error);
  dict["bound"] = to_python(instance.bound);
  dict["members"] = members_of(instance.members);
  return dict;
}

}  // namespace

py::list snapshots_of(const ltm::MemoryId& entity,
                      const std::vector<ltm::SnapshotResult>& of_entity) {
  py::list snapshots;
  for (const ltm::SnapshotResult& found : of_entity) {
    py::list instances;
    for (const ltm::InstanceResult& instance : found.instances)
      instances.append(instance_of(instance));
    py::dict dict;
    dict["entity"] = entity.to_string();
    dict["time"] = to_ns(found.time);
    dict["source"] = std::string(ltm::to_string(found.source));
    dict["model"] = found.model;
    dict["predictor"] = found.predictor;
    dict["horizon"] = found.horizon.count();
    dict["plan"] = found.plan;
    dict["instances"] = std::move(instances);
    snapshots.append(std::move(dict));
  }
  return snapshots;
}

std::vector<int64_t> times_in(const ltm::QueryResult& answer, const ltm::MemoryId& entity) {
  std::vector<int64_t> times;
  if (const ltm::EntityResult* found = answer.find_entity(entity))
    for (const ltm::SnapshotResult& one : found->snapshots) times.push_back(to_ns(one.time));
  return times;
}

py::list answer_of(const ltm::QueryResult& result) {
  py::list answer;
  for (const ltm::EntityResult* found : result.entities())
    answer.append(py::make_tuple(found->id.to_string(), snapshots_of(found->id, found->snapshots)));
  return answer;
}

py::list engines_of(const std::vector<ltm::EngineRecord>& records) {
  py::list engines;
  for (const ltm::EngineRecord& record : records) {
    py::dict engine;
    engine["name"] = record.engine;
    engine["model"] = record.model;
    engine["predictions"] = record.predictions;
    engine["error"] = to_python(record.mean);
    engine["bound"] = to_python(record.bound);
    engines.append(std::move(engine));
  }
  return engines;
}

}  // namespace engram::python
