// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// What an encoder made of one value: the code of its tensor members, and the remainder that
/// cannot be a tensor, as it was.
struct Latent {
  Buffer code;
  idf::List remainder;
};

/// How far a decoded value is from the recorded one, measured after decoding what is stored.
/// Not a number where the value has no member of that kind.
struct MeasuredError {
  /// Mean squared error over all elements of all image members. Unit: grey levels squared.
  double image_mse = std::numeric_limits<double>::quiet_NaN();
  /// Mean squared error over all other tensor elements. Unit: that of the numbers, squared.
  double number_mse = std::numeric_limits<double>::quiet_NaN();
};

struct LatentInstance {
  Latent latent;
  InstanceMetadata metadata;
  MeasuredError error;
};

/// One snapshot as latents of version `model_version` of its entity's model.
struct LatentSnapshot {
  Time time{};
  int model_version = 0;
  std::vector<LatentInstance> instances;
};

}  // namespace engram::ltm
