// SPDX-License-Identifier: Apache-2.0
// The extension module behind the package `engram`; no other code imports it. So nothing here has
// names of arguments, defaults or docstrings: the package gives them, and _core.pyi the types.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "encoders/threads.h"
#include "python/bindings/bound_skills.h"
#include "python/bindings/front_door.h"
#include "python/bindings/inspected_model.h"
#include "python/bindings/jobs.h"
#include "python/bindings/open_store.h"
#include "python/bindings/store_recorder.h"
#include "python/bindings/values.h"
#include "python/bindings/watch.h"

namespace {

namespace py = pybind11;
using engram::Duration;
using engram::python::FrontDoor;
using engram::python::InspectedModel;
using engram::python::OpenStore;
using engram::python::StoreRecorder;
using engram::python::Watch;

// Options come one by one, so that Python needs no class for them. Durations come in nanoseconds,
// because Python's timedelta has only microseconds.
std::unique_ptr<FrontDoor> open_door(const std::string& store, size_t working_bytes,
                                     bool prefers_latents, int64_t horizon,
                                     const std::string& config) {
  engram::OpenOptions options;
  options.max_working_bytes = working_bytes;
  options.prefers_latents = prefers_latents;
  options.max_horizon = Duration(horizon);
  options.recording_config = config;
  return FrontDoor::open(store, options);
}

std::unique_ptr<FrontDoor> connect_door(const std::string& endpoint, const std::string& token,
                                        const std::string& ca, int64_t timeout) {
  engram::ConnectOptions options;
  options.token = token;
  options.ca = ca;
  options.timeout = Duration(timeout);
  return FrontDoor::connect(endpoint, options);
}

std::unique_ptr<FrontDoor> replay_door(const std::string& store, std::optional<int64_t> at,
                                       double speed, bool is_paused,
                                       std::optional<std::pair<int64_t, int64_t>> loop) {
  engram::ReplayOptions options{.speed = speed, .is_paused = is_paused};
  if (at) options.at = engram::time_from_ns(*at);
  if (loop) options.loop = {engram::time_from_ns(loop->first), engram::time_from_ns(loop->second)};
  return FrontDoor::replay(store, options);
}

std::unique_ptr<Watch> watch(FrontDoor& door, std::vector<std::string> names, bool with_data,
                             size_t inline_bytes, size_t queue_bound) {
  return door.watch({std::move(names), with_data, inline_bytes, queue_bound});
}

void define_front_door(py::module_& module) {
  py::class_<Watch>(module, "Watch")
      .def("next", &Watch::next)
      .def("close", &Watch::close)
      .def("is_closed", &Watch::is_closed)
      .def("lost", &Watch::lost)
      .def("interruptions", &Watch::interruptions);
  py::class_<FrontDoor> door(module, "FrontDoor");
  bind_similar(door);
  door.def_static("open", &open_door)
      .def_static("connect", &connect_door)
      .def_static("replay", &replay_door)
      .def_static("read", &FrontDoor::read)
      .def("ask", &FrontDoor::ask)
      .def("tell", &FrontDoor::tell)
      .def("entities", &FrontDoor::entities)
      .def("summary", &FrontDoor::summary)
      .def("span", &FrontDoor::span)
      .def("times", &FrontDoor::times)
      .def("selected_times", &FrontDoor::selected_times)
      .def("select", &FrontDoor::select)
      .def("query", &FrontDoor::query)
      .def("predict", &FrontDoor::predict)
      .def("engines", &FrontDoor::engines)
      .def("declare", &FrontDoor::declare)
      .def("commit", &FrontDoor::commit)
      .def("watch", &watch)
      .def("close", &FrontDoor::close);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ side of engram; private to the package.";
  py::class_<OpenStore> store(module, "OpenStore");
  bind_similar(store);
  store
      // From a text: a path would need pybind11's conversion of paths.
      .def(py::init([](const std::string& path) { return std::make_unique<OpenStore>(path); }))
      .def("entities", &OpenStore::entities)
      .def("summary", &OpenStore::summary)
      .def("span", &OpenStore::span)
      .def("times", &OpenStore::times)
      .def("selected_times", &OpenStore::selected_times)
      .def("select", &OpenStore::select)
      .def("query", &OpenStore::query)
      .def("predict", &OpenStore::predict)
      .def("engines", &OpenStore::engines)
      .def("why_salient", &OpenStore::why_salient)
      .def("models", &OpenStore::models)
      .def("stored_snapshots", &OpenStore::stored_snapshots)
      .def("latents", &OpenStore::latents)
      .def("refresh", &OpenStore::refresh)
      .def("close", &OpenStore::close);
  py::class_<StoreRecorder>(module, "StoreRecorder")
      .def(py::init<const std::string&, const std::string&, const std::string&>())
      .def("commit", &StoreRecorder::commit)
      .def("counts", &StoreRecorder::counts)
      .def("close", &StoreRecorder::close);
  define_front_door(module);
#if ENGRAM_HAS_SERVERS
  engram::python::define_skills(module);
#endif
  py::class_<InspectedModel>(module, "InspectedModel")
      .def(py::init<const std::string&>())
      .def("about", &InspectedModel::about)
      .def("weights", &InspectedModel::weights)
      .def("encode", &InspectedModel::encode)
      .def("decode", &InspectedModel::decode)
      .def("global_codes", &InspectedModel::global_codes)
      .def("predict", &InspectedModel::predict);
  module.def("check", &engram::python::check);
  module.def("notice", &engram::python::notice);
  module.def("reflect", &engram::python::reflect);
  module.def("forget", &engram::python::forget);
  module.def("consolidate", &engram::python::consolidate);
  module.def("set_threads", &engram::encoders::set_threads);
  // For tests of the conversions alone.
  module.def("round_trip", [](const py::object& value) {
    return engram::python::to_python(engram::python::from_python(value));
  });
}
