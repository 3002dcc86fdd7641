// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/query_result.h"

#include "python/bindings/measured_error.h"
#include "python/bindings/values.h"

namespace engram::python {

namespace {

namespace py = pybind11;

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
    dict["instances"] = std::move(instances);
    snapshots.append(std::move(dict));
  }
  return snapshots;
}

}  // namespace engram::python
