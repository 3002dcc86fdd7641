// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "ltm/codec/packed_value.h"
#include "ltm/core/buffer.h"
#include "ltm/memory/snapshot.h"
#include "ltm/memory/source.h"

namespace engram::ltm {

/// The output of an encoder for one value: the code of its tensor members, and the remainder, the
/// parts that are not tensors, unchanged.
///
/// Consecutive snapshots of an entity may be coded together as one block, which is stored once.
struct Latent {
  Buffer code;  ///< The code of the whole block. All rows of the block share it.
  idf::List remainder;
  GroupPlace place = {};  ///< Place in the block; 0 of 1 if the latent is coded alone.
};

struct LatentInstance {
  Latent latent;
  InstanceMetadata metadata;
  MeasuredError error;
};

/// One snapshot as latents, coded by version `model_version` of its entity's model.
struct LatentSnapshot {
  Time time{};
  int model_version = 0;
  std::vector<LatentInstance> instances;
};

/// Codes the remaining rows of a block again when its other rows are forgotten, so that the bytes
/// no longer contain information about those. It receives latents of one block in block order and
/// returns one latent for each, which decodes to the same value. Only `code` and `place` of the
/// results are used; the remainders stay as they are.
using LatentRecoder = std::function<Result<std::vector<Latent>>(
    const MemoryId& entity, int model_version, std::span<const Latent> kept)>;

}  // namespace engram::ltm
