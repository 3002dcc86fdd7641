// SPDX-License-Identifier: Apache-2.0
// What the package `engram` stands on; nobody else imports it.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "python/bindings/open_store.h"

namespace {

namespace py = pybind11;
using engram::python::OpenStore;

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
      .def("close", &OpenStore::close);
}
