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

/// What an encoder made of one value: the code of its tensor members, and the remainder that
/// cannot be a tensor, as it was.
///
/// Consecutive snapshots of an entity may be coded as one block, which is stored once.
struct Latent {
  Buffer code;  ///< Of the whole block, shared by its rows.
  idf::List remainder;
  GroupPlace place = {};  ///< In the block. Alone: 0 of 1.
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

/// Codes anew what is left of a block whose other rows are to go, so that its bytes tell nothing of
/// these any more. Gets latents of one block in its order; gives one for each, which decodes to
/// the same: code and place count, remainders stay as they are.
using LatentRecoder = std::function<Result<std::vector<Latent>>(
    const MemoryId& entity, int model_version, std::span<const Latent> kept)>;

}  // namespace engram::ltm
