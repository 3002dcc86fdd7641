// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/core/buffer.h"
#include "ltm/memory/snapshot.h"
#include "ltm/memory/source.h"

namespace engram::ltm {

/// What an encoder made of one value: the code of its tensor members, and the remainder that
/// cannot be a tensor, as it was.
struct Latent {
  Buffer code;
  idf::List remainder;
  GroupPlace place = {};
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
