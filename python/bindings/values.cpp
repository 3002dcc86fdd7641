// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/values.h"

#include <pybind11/numpy.h>

namespace engram::python {

namespace {

namespace py = pybind11;

/// A text as Python has it; bytes that are no UTF-8 as surrogate escapes.
py::object to_text(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
}

/// The buffer lives as long as the array, or a view of it.
py::object to_array(const idf::NdArray& array) {
  auto owner = std::make_unique<idf::NdArray>(array);
  const void* data = owner->bytes().data();
  const py::capsule keeper(owner.release(),
                           [](void* kept) { delete static_cast<idf::NdArray*>(kept); });
  const std::vector<py::ssize_t> shape(array.shape().begin(), array.shape().end());
  py::array view(py::dtype(std::string(idf::to_string(array.type()))), shape, data, keeper);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

class Converter {
 public:
  py::object operator()(idf::None) const { return py::none(); }
  py::object operator()(bool value) const { return py::bool_(value); }
  py::object operator()(int32_t value) const { return numpy_.attr("int32")(value); }
  py::object operator()(int64_t value) const { return numpy_.attr("int64")(value); }
  py::object operator()(float value) const { return numpy_.attr("float32")(value); }
  py::object operator()(double value) const { return numpy_.attr("float64")(value); }
  py::object operator()(const std::string& value) const { return to_text(value); }
  py::object operator()(const idf::NdArray& value) const { return to_array(value); }
  py::object operator()(const idf::List& value) const {
    py::list list;
    for (const idf::Data& each : value) list.append(convert(each));
    return list;
  }
  py::object operator()(const idf::Dict& value) const {
    py::dict dict;
    for (const auto& [key, each] : value) dict[to_text(key)] = convert(each);
    return dict;
  }

  [[nodiscard]] py::object convert(const idf::Data& value) const {
    return std::visit(*this, value.value());
  }

 private:
  py::module_ numpy_ = py::module_::import("numpy");
};

}  // namespace

py::object to_python(const idf::Data& value) {
  return Converter().convert(value);
}

}  // namespace engram::python
