// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/bound_similar.h"

#include "python/bindings/bound_commit.h"
#include "python/bindings/errors.h"
#include "python/bindings/values.h"

namespace engram::python {

namespace py = pybind11;

ltm::SimilarRequest similar_request_of(const SimilarArguments& asked) {
  ltm::SimilarRequest request{value_or_raise(entity_of(asked.entity))};
  if (asked.moment) request.moment = time_from_ns(*asked.moment);
  if (asked.image) {
    const idf::Data value = from_python(*asked.image);
    if (const auto* array = value.get_if<idf::NdArray>()) request.image = *array;
  }
  for (const auto& [name, weight] : asked.with_entities)
    request.with.push_back({value_or_raise(entity_of(name)), weight});
  if (!asked.among.empty()) request.among = value_or_raise(ltm::Query::parse(asked.among));
  request.count = asked.count;
  request.apart = Duration(asked.apart);
  request.context = Duration(asked.context);
  request.is_one_per_recording = asked.is_one_per_recording;
  request.is_elsewhere = asked.is_elsewhere;
  request.takes_any_size = asked.takes_any_size;
  return request;
}

py::dict similar_of(const ltm::SimilarAnswer& answer) {
  py::list moments;
  for (const ltm::SimilarMoment& one : answer.moments) {
    py::dict moment;
    moment["time"] = to_ns(one.time);
    moment["distance"] = one.distance;
    moment["recording"] = py::make_tuple(to_ns(one.recording_first), to_ns(one.recording_last));
    moments.append(std::move(moment));
  }
  py::dict found;
  found["space"] = answer.space;
  found["compared"] = answer.compared;
  found["computed"] = answer.computed;
  found["moments"] = std::move(moments);
  return found;
}

}  // namespace engram::python
