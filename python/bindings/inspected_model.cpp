// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/inspected_model.h"

#include <pybind11/stl.h>

#include "python/bindings/errors.h"
#include "python/bindings/measured_error.h"
#include "python/bindings/values.h"

namespace engram::python {

namespace {

namespace py = pybind11;
using encoders::LatentArrays;
using encoders::LatentMember;
using encoders::OpenModel;

/// Returns an array that owns `values`, without copying them.
template <typename T>
py::array array_of(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto owner = std::make_unique<std::vector<T>>(std::move(values));
  const T* data = owner->data();
  const py::capsule keeper(owner.release(),
                           [](void* kept) { delete static_cast<std::vector<T>*>(kept); });
  return py::array(py::dtype::of<T>(), std::move(shape), data, keeper);
}

/// Returns a member of a dict as a flat vector. Raises if its shape differs.
template <typename T>
std::vector<T> vector_of(const py::handle& given, const std::string& name,
                         std::vector<py::ssize_t> shape) {
  const auto array = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(given);
  if (!array) throw py::error_already_set();
  if (std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()) != shape)
    raise(invalid_argument("latents: '{}' has shape {}, needs [{}]", name,
                           py::str(array.attr("shape")).template cast<std::string>(),
                           fmt::join(shape, ", ")));
  return std::vector<T>(array.data(), array.data() + array.size());
}

LatentArrays arrays_of(const OpenModel& model, const py::dict& given) {
  LatentArrays arrays;
  const auto remainders = given["remainders"].cast<py::list>();
  const auto count = static_cast<py::ssize_t>(remainders.size());
  for (const py::handle& each : remainders) {
    const idf::Data remainder = python::from_python(each);
    const auto* list = remainder.get_if<idf::List>();
    if (list == nullptr) raise(invalid_argument("latents: a remainder is no list"));
    arrays.remainders.push_back(*list);
  }
  for (const int64_t scene : vector_of<int64_t>(given["scenes"], "scenes", {count})) {
    // Python holds scenes as int64, so one out of range is refused, not truncated.
    if (scene < 0 || scene > std::numeric_limits<uint32_t>::max())
      raise(invalid_argument("latents: found scene {}", scene));
    arrays.scenes.push_back(static_cast<uint32_t>(scene));
  }
  const auto images = given["images"].cast<py::dict>();
  for (const LatentMember& member : model.images()) {
    if (!images.contains(member.path.c_str()))
      raise(invalid_argument("latents: found none of image '{}'", member.path));
    arrays.images.push_back(vector_of<int32_t>(images[member.path.c_str()], member.path,
                                               {count, static_cast<py::ssize_t>(member.count())}));
  }
  arrays.numbers = vector_of<double>(given["numbers"], "numbers",
                                     {count, static_cast<py::ssize_t>(model.numbers().size())});
  return arrays;
}

std::vector<idf::Data> values_of(const py::list& given) {
  std::vector<idf::Data> values;
  for (const py::handle& value : given) values.push_back(python::from_python(value));
  return values;
}

py::tuple shape_of(const encoders::LatentGrid& grid) {
  return py::make_tuple(grid.channels, grid.height, grid.width);
}

py::list curve_of(const encoders::Provenance& from) {
  py::list curve;
  for (const encoders::CurvePoint& point : from.curve)
    curve.append(py::make_tuple(point.phase, point.step, point.seconds, point.loss, point.psnr_db,
                                point.bytes));
  return curve;
}

/// Returns latents in the form of encode().
py::dict dict_of(const OpenModel& model, LatentArrays arrays) {
  const auto count = static_cast<py::ssize_t>(arrays.scenes.size());
  py::dict images, is_latent;
  for (size_t i = 0; i < arrays.images.size(); ++i) {
    const LatentMember& member = model.images()[i];
    images[py::str(member.path)] =
        array_of(std::move(arrays.images[i]), {count, static_cast<py::ssize_t>(member.count())});
    std::vector<uint8_t> flags(arrays.is_latent[i].begin(), arrays.is_latent[i].end());
    is_latent[py::str(member.path)] = array_of(std::move(flags), {count}).attr("astype")("bool");
  }
  py::dict dict;
  dict["scenes"] =
      array_of(std::vector<int64_t>(arrays.scenes.begin(), arrays.scenes.end()), {count});
  dict["images"] = std::move(images);
  dict["is_latent"] = std::move(is_latent);
  dict["numbers"] = array_of(std::move(arrays.numbers),
                             {count, static_cast<py::ssize_t>(model.numbers().size())});
  py::list remainders;
  for (idf::List& remainder : arrays.remainders)
    remainders.append(python::to_python(idf::Data(std::move(remainder))));
  dict["remainders"] = std::move(remainders);
  return dict;
}

}  // namespace

InspectedModel::InspectedModel(const std::string& file)
    : model_([&] {
        auto opened = [&] {
          const py::gil_scoped_release released;
          return OpenModel::open(file);
        }();
        return value_or_raise(std::move(opened));
      }()) {}

template <typename Work>
auto InspectedModel::without_gil(Work work) {
  auto result = [&] {
    const py::gil_scoped_release released;
    const MutexLock lock(mutex_);
    return work();
  }();
  return value_or_raise(std::move(result));
}

py::dict InspectedModel::about() {
  const encoders::Provenance& from = model_.provenance();
  py::dict about;
  about["entity"] = from.entity;
  about["variant"] = std::string(to_string(from.variant));
  about["seed"] = from.seed;
  about["steps"] = from.steps;
  about["training_seconds"] = from.training_seconds;
  about["snapshots"] = from.snapshots;
  about["psnr_db"] = from.psnr_db;
  about["started_from"] = from.started_from;
  about["step"] = model_.predictor().step().count();
  py::dict images;
  for (const LatentMember& member : model_.images())
    images[py::str(member.path)] = py::make_tuple(shape_of(member.coarse), shape_of(member.fine));
  about["images"] = std::move(images);
  about["numbers"] = model_.numbers();
  py::dict members;
  for (const idf::TensorMember& member : model_.layout().members())
    members[py::str(member.path)] = std::string(idf::to_string(member.kind));
  about["members"] = std::move(members);
  about["curve"] = curve_of(from);
  return about;
}

py::dict InspectedModel::weights() {
  const auto found = [&] {
    const py::gil_scoped_release released;
    const MutexLock lock(mutex_);
    return model_.weights();
  }();
  py::dict weights;
  for (const encoders::NamedWeights& one : found)
    weights[py::str(one.name)] = to_python(one.values);
  return weights;
}

py::dict InspectedModel::encode(const py::list& values) {
  const auto given = values_of(values);
  return dict_of(model_, without_gil([&] { return model_.encode(given); }));
}

py::dict InspectedModel::stored(const std::vector<ltm::Latent>& latents) {
  return dict_of(model_, without_gil([&] { return model_.stored(latents); }));
}

py::list InspectedModel::decode(const py::dict& latents) {
  const LatentArrays arrays = arrays_of(model_, latents);
  py::list values;
  for (const idf::Data& value : without_gil([&] { return model_.decode(arrays); }))
    values.append(to_python(value));
  return values;
}

py::array InspectedModel::global_codes(const py::list& values) {
  const auto given = values_of(values);
  const auto codes = without_gil([&] { return model_.global_codes(given); });
  const auto each = static_cast<py::ssize_t>(codes.empty() ? 0 : codes.front().size());
  std::vector<float> flat;
  for (const auto& code : codes) flat.insert(flat.end(), code.begin(), code.end());
  return array_of(std::move(flat), {static_cast<py::ssize_t>(codes.size()), each});
}

py::list InspectedModel::predict(const py::list& past, int steps) {
  const auto given = values_of(past);
  const auto ahead = without_gil([&] { return model_.predictor().predict(given, steps); });
  py::list predictions;
  for (const ltm::Prediction& one : ahead) {
    py::dict dict;
    dict["value"] = to_python(one.value);
    dict["error"] = to_python(one.error.expected);
    dict["bound"] = to_python(one.error.bound);
    predictions.append(std::move(dict));
  }
  return predictions;
}

}  // namespace engram::python
