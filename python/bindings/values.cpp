// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/values.h"

#include "ltm/idf/binary.h"
#include "python/bindings/errors.h"

namespace engram::python {

namespace {

namespace py = pybind11;

/// Converts a text to a Python str; bytes that are not UTF-8 become surrogate escapes.
py::object to_text(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape"));
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
  py::object operator()(const idf::NdArray& value) const { return to_python(value); }
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

/// Converts values from Python and tracks the path to the current one for messages.
class Reader {
 public:
  idf::Data read(const py::handle& given) {
    if (++depth_ > idf::kMaxDepth) refuse("lists and dicts within each other", "deeper");
    const py::object value = py::hasattr(given, "to_idf")
                                 ? given.attr("to_idf")()
                                 : py::reinterpret_borrow<py::object>(given);
    idf::Data data = read_plain(value);
    --depth_;
    return data;
  }

 private:
  idf::Data read_plain(const py::object& value) {
    if (value.is_none()) return {};
    if (PyBool_Check(value.ptr()) || py::isinstance(value, bool_))
      return py::bool_(value).cast<bool>();
    if (py::isinstance(value, int32_))
      return static_cast<int32_t>(PyNumber_AsSsize_t(value.ptr(), nullptr));
    if (py::isinstance(value, int64_) || PyLong_Check(value.ptr())) return read_integer(value);
    if (py::isinstance(value, float32_)) return static_cast<float>(PyFloat_AsDouble(value.ptr()));
    if (PyFloat_Check(value.ptr())) return PyFloat_AsDouble(value.ptr());
    if (PyUnicode_Check(value.ptr())) return read_text(value);
    if (py::isinstance<py::array>(value)) return read_array(value);
    if (PyList_Check(value.ptr()) || PyTuple_Check(value.ptr())) return read_list(value);
    if (PyDict_Check(value.ptr())) return read_dict(value);
    refuse("a value", "of Python type " + std::string(Py_TYPE(value.ptr())->tp_name));
  }

  idf::Data read_integer(const py::object& value) {
    int overflow = 0;
    const py::object index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!index) throw py::error_already_set();
    const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    if (overflow != 0) refuse("a number", "beyond 64 bits");
    return static_cast<int64_t>(number);
  }

  std::string read_text(const py::handle& text) {
    const py::object bytes = py::reinterpret_steal<py::object>(
        PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape"));
    if (!bytes) throw py::error_already_set();
    return bytes.cast<std::string>();
  }

  idf::Data read_array(const py::object& given) {
    const auto type = idf::element_type_from_name(
        py::str(given.attr("dtype").attr("newbyteorder")("=").attr("name")).cast<std::string>());
    if (!type) refuse("an array", "of " + py::str(given.attr("dtype")).cast<std::string>());
    const py::dtype dtype{std::string(idf::to_string(*type))};
    const py::array array = numpy_.attr("ascontiguousarray")(given, dtype).cast<py::array>();
    // The shape is taken from the given array, because ascontiguousarray adds an axis to a scalar
    // array.
    const auto given_array = py::reinterpret_borrow<py::array>(given);
    idf::Shape shape(given_array.shape(), given_array.shape() + given_array.ndim());
    const auto* first = static_cast<const std::byte*>(array.data());
    auto made = idf::NdArray::create(*type, std::move(shape),
                                     aligned_copy({first, static_cast<size_t>(array.nbytes())}));
    return value_or_raise(std::move(made));
  }

  idf::Data read_list(const py::object& value) {
    idf::List list;
    const size_t size = py::len(value);
    list.reserve(size);
    for (size_t i = 0; i < size; ++i)
      list.push_back(below(std::to_string(i), py::reinterpret_borrow<py::sequence>(value)[i]));
    return list;
  }

  idf::Data read_dict(const py::object& value) {
    idf::Dict dict;
    for (const auto& [key, each] : py::reinterpret_borrow<py::dict>(value)) {
      if (!PyUnicode_Check(key.ptr())) refuse("a key", py::repr(key).cast<std::string>());
      std::string name = read_text(key);
      idf::Data read = below(name, each);
      dict.append_unique(std::move(name), std::move(read));
    }
    return dict;
  }

  idf::Data below(const std::string& name, const py::handle& value) {
    const size_t length = path_.size();
    path_ = idf::join_path(path_, name);
    idf::Data data = read(value);
    path_.resize(length);
    return data;
  }

  /// Copies bytes to memory that is aligned for any element type.
  static Buffer aligned_copy(std::span<const std::byte> bytes) {
    std::vector<double> room((bytes.size() + sizeof(double) - 1) / sizeof(double));
    std::memcpy(room.data(), bytes.data(), bytes.size());
    return Buffer::take(std::move(room)).slice(0, bytes.size());
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& found) const {
    raise(invalid_argument("value{}: found {} {}, needs what docs/idf.md lists",
                           path_.empty() ? "" : " at '" + path_ + "'", what, found));
  }

  py::module_ numpy_ = py::module_::import("numpy");
  py::object bool_ = numpy_.attr("bool_"), int32_ = numpy_.attr("int32"),
             int64_ = numpy_.attr("int64"), float32_ = numpy_.attr("float32");
  std::string path_;
  int depth_ = 0;
};

}  // namespace

py::object to_python(const idf::Data& value) {
  return Converter().convert(value);
}

py::array to_python(const idf::NdArray& array) {
  auto owner = std::make_unique<idf::NdArray>(array);
  const void* data = owner->bytes().data();
  const py::capsule keeper(owner.release(),
                           [](void* kept) { delete static_cast<idf::NdArray*>(kept); });
  const std::vector<py::ssize_t> shape(array.shape().begin(), array.shape().end());
  py::array view(py::dtype(std::string(idf::to_string(array.type()))), shape, data, keeper);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

idf::Data from_python(const py::handle& value) {
  return Reader().read(value);
}

}  // namespace engram::python
