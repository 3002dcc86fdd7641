// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/bound_commit.h"

#include "python/bindings/errors.h"
#include "python/bindings/values.h"

namespace engram::python {

namespace {

namespace py = pybind11;

/// Returns a member of a dict from Python. For a wrong kind, pybind11 alone would only say that it
/// cannot be cast.
template <typename T>
T member(const py::dict& given, const char* name, const std::string& where, const char* needed) {
  const py::object found = given[name];
  try {
    return found.cast<T>();
  } catch (const py::cast_error&) {
    raise(invalid_argument("{}: found {} {} of Python type {}, needs {}", where, name,
                           py::repr(found).cast<std::string>(), Py_TYPE(found.ptr())->tp_name,
                           needed));
  }
}

ltm::Instance instance_of(const py::dict& given, Time time, const std::string& where) {
  ltm::Instance instance;
  instance.data = from_python(given["value"]);
  const auto time_at = [&](const char* name, Time otherwise) {
    if (given[name].is_none()) return otherwise;
    return time_from_ns(member<int64_t>(given, name, where, "nanoseconds since 1970"));
  };
  instance.metadata.created = time_at("created", time);
  instance.metadata.sent = time_at("sent", instance.metadata.created);
  instance.metadata.arrived = system_now();
  instance.metadata.provider = member<std::string>(given, "provider", where, "a text");
  instance.metadata.confidence = member<float>(given, "confidence", where, "a number, 0 to 1");
  return instance;
}

ltm::EntityUpdate update_of(const py::dict& given) {
  const auto name = member<std::string>(given, "entity", "update", "the name of an entity");
  const std::string where = "update of '" + name + "'";
  ltm::EntityUpdate update;
  update.entity = value_or_raise(ltm::MemoryId::parse(name));
  update.time = time_from_ns(member<int64_t>(given, "time", where, "nanoseconds since 1970"));
  for (const py::handle& instance : given["instances"].cast<py::list>())
    update.instances.push_back(instance_of(instance.cast<py::dict>(), update.time, where));
  return update;
}

}  // namespace

ltm::Commit commit_of(const py::list& updates) {
  ltm::Commit commit;
  for (const py::handle& update : updates)
    commit.updates.push_back(update_of(update.cast<py::dict>()));
  return commit;
}

Result<ltm::MemoryId> entity_of(const std::string& name) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(name));
  if (id.is_entity()) return id;
  return invalid_argument("'{}': needs an entity, four names", name);
}

}  // namespace engram::python
