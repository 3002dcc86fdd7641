// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>

#include <string>

#include "encoders/open_model.h"
#include "ltm/core/mutex.h"

namespace engram::python {

/// A model file that Python inspects. Networks run without the GIL.
///
/// Errors: exceptions of engram.errors.
/// Threading: any thread; calls run one after the other.
class InspectedModel {
 public:
  explicit InspectedModel(const std::string& file);

  /// What is known about the model: provenance, members, training curve.
  pybind11::dict about();
  /// The weights: arrays of float32, keyed by name.
  pybind11::dict weights();

  /// Encodes values to latents.
  /// Shape: {"scenes": int64 [N], "images": {path: int32 [N, L]}, "is_latent": {path: bool [N]},
  /// "numbers": float64 [N, K], "remainders": list}.
  pybind11::dict encode(const pybind11::list& values);
  /// Converts latents of a store to the same form. Needs the GIL.
  pybind11::dict stored(const std::vector<ltm::Latent>& latents);
  /// Decodes such a dict to values.
  pybind11::list decode(const pybind11::dict& latents);
  /// The global codes of values.
  /// Shape: float32 [N, 48].
  pybind11::array global_codes(const pybind11::list& values);
  /// Predicts 1..`steps` steps after the last value of `past`: dicts with "value", "error",
  /// "bound".
  pybind11::list predict(const pybind11::list& past, int steps);

 private:
  template <typename Work>
  auto without_gil(Work work);

  Mutex mutex_;  ///< Held while networks of `model_` run; its constant properties need no lock.
  encoders::OpenModel model_;
};

}  // namespace engram::python
