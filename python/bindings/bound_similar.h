// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <optional>
#include <string>

#include "ltm/likeness/moment_map.h"
#include "ltm/likeness/similar_moments.h"

namespace engram::python {

/// What engram.Entity.similar asks.
struct SimilarArguments {
  std::string entity;
  std::optional<int64_t> moment;         ///< Unit: ns.
  std::optional<pybind11::array> image;  ///< One of this and `moment`.
  std::string among;                     ///< A query; empty: all moments.
  size_t count = 10;
  int64_t apart = 0;    ///< Unit: ns.
  int64_t context = 0;  ///< Unit: ns.
  bool is_one_per_recording = false;
  bool is_elsewhere = false;
  bool takes_any_size = false;
  std::map<std::string, double> with_entities;  ///< Other entities and their weights.
};

/// Raises the exceptions of values and queries that cannot be read. Needs the GIL.
[[nodiscard]] ltm::SimilarRequest similar_request_of(const SimilarArguments& asked);

/// A dict with "space", "compared", "computed" and "moments", the nearest first: dicts with "time",
/// "distance" and "recording" (first and last, ns). Needs the GIL.
[[nodiscard]] pybind11::dict similar_of(const ltm::SimilarAnswer& answer);

/// A dict with "space", "known", "explained" and the columns "times" (ns), "x", "y" and
/// "recordings". Needs the GIL.
[[nodiscard]] pybind11::dict map_of(const ltm::MomentMap& map);

/// Binds map() of a class, and similar(), whose arguments are those of SimilarArguments in their
/// order.
template <typename Bound>
void bind_similar(pybind11::class_<Bound>& bound) {
  bound.def("map", &Bound::map);
  bound.def("similar",
            [](Bound& memory, std::string entity, std::optional<int64_t> moment,
               std::optional<pybind11::array> image, std::string among, size_t count, int64_t apart,
               int64_t context, bool is_one_per_recording, bool is_elsewhere, bool takes_any_size,
               std::map<std::string, double> with_entities) {
              return memory.similar({std::move(entity), moment, std::move(image), std::move(among),
                                     count, apart, context, is_one_per_recording, is_elsewhere,
                                     takes_any_size, std::move(with_entities)});
            });
}

}  // namespace engram::python
