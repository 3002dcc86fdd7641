// SPDX-License-Identifier: Apache-2.0
// What the package `engram` stands on; nobody else imports it.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "encoders/threads.h"
#include "python/bindings/inspected_model.h"
#include "python/bindings/jobs.h"
#include "python/bindings/open_store.h"
#include "python/bindings/store_recorder.h"
#include "python/bindings/values.h"

namespace {

namespace py = pybind11;
using engram::python::InspectedModel;
using engram::python::OpenStore;
using engram::python::StoreRecorder;

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.doc() = "The C++ side of engram; private to the package.";
  py::class_<OpenStore>(module, "OpenStore")
      .def(py::init([](const std::string& path) { return std::make_unique<OpenStore>(path); }))
      .def("entities", &OpenStore::entities)
      .def("summary", &OpenStore::summary)
      .def("times", &OpenStore::times)
      .def("select", &OpenStore::select)
      .def("query", &OpenStore::query)
      .def("predict", &OpenStore::predict)
      .def("engines", &OpenStore::engines)
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
  py::class_<InspectedModel>(module, "InspectedModel")
      .def(py::init<const std::string&>())
      .def("about", &InspectedModel::about)
      .def("weights", &InspectedModel::weights)
      .def("encode", &InspectedModel::encode)
      .def("decode", &InspectedModel::decode)
      .def("global_codes", &InspectedModel::global_codes)
      .def("predict", &InspectedModel::predict);
  module.def("check", &engram::python::check);
  module.def("forget", &engram::python::forget);
  module.def("consolidate", &engram::python::consolidate);
  module.def("set_threads", &engram::encoders::set_threads);
  module.def("round_trip", [](const py::object& value) {
    return engram::python::to_python(engram::python::from_python(value));
  });
}
