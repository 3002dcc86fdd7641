// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>

#include <string>

#include "encoders/open_model.h"
#include "ltm/core/mutex.h"

namespace engram::python {

/// A model file that Python looks into. Networks run without the GIL.
///
/// Errors: exceptions of engram.errors.
/// Threading: any thread; one call after the other.
class InspectedModel {
 public:
  explicit InspectedModel(const std::string& file);

  /// What is known of it: provenance, members, curve.
  pybind11::dict about();
  /// Arrays of float32 by name.
  pybind11::dict weights();

  /// {"scenes": int64 [N], "images": {path: int32 [N, L]}, "is_latent": {path: bool [N]},
  /// "numbers": float64 [N, K], "remainders": list}.
  pybind11::dict encode(const pybind11::list& values);
  /// The same of latents of a store. Needs the GIL.
  pybind11::dict stored(const std::vector<ltm::Latent>& latents);
  /// Values, of such a dict.
  pybind11::list decode(const pybind11::dict& latents);
  /// float32 [N, 48].
  pybind11::array global_codes(const pybind11::list& values);
  /// Of 1..steps steps after the last of `past`: dicts with "value", "error", "bound".
  pybind11::list predict(const pybind11::list& past, int steps);

 private:
  template <typename Work>
  auto without_gil(Work work);

  Mutex mutex_;  ///< Held while networks of `model_` run; what it only tells needs no lock.
  encoders::OpenModel model_;
};

}  // namespace engram::python
