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

py::dict map_of(const ltm::MomentMap& map) {
  py::array_t<int64_t> times(static_cast<py::ssize_t>(map.times.size()));
  for (size_t i = 0; i < map.times.size(); ++i)
    times.mutable_at(static_cast<py::ssize_t>(i)) = to_ns(map.times[i]);
  const auto column = [](const auto& numbers) {
    using Number = typename std::decay_t<decltype(numbers)>::value_type;
    return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
  };
  py::dict found;
  found["space"] = map.space;
  found["known"] = map.known;
  found["explained"] = map.explained;
  found["times"] = std::move(times);
  found["x"] = column(map.x);
  found["y"] = column(map.y);
  found["recordings"] = column(map.recordings);
  return found;
}

}  // namespace engram::python
