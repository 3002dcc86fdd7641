// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
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

/// How good a latent is.
struct LatentQuality {
  /// The error against what was recorded: measured, or an estimate where there is a bound.
  MeasuredError error;
  /// The largest that the error can be, where the recorded form was gone when the snapshot faded.
  std::optional<MeasuredError> bound = {};
  /// The min PSNR that the snapshot faded to (docs/forgetting.md, "Memories that fade"); 0 if a
  /// gist is left, which fades no further. Unit: dB.
  float faded_to_db = kNotFaded;

  static constexpr float kNotFaded = std::numeric_limits<float>::infinity();
  static constexpr float kGist = 0;

  /// The error that the value certainly does not exceed.
  [[nodiscard]] const MeasuredError& certain() const { return bound ? *bound : error; }

  friend bool operator==(const LatentQuality&, const LatentQuality&) = default;
};

struct LatentInstance {
  Latent latent;
  InstanceMetadata metadata;
  LatentQuality quality;
};

/// One snapshot as latents, coded by version `model_version` of its entity's model.
struct LatentSnapshot {
  Time time{};
  int model_version = 0;
  std::vector<LatentInstance> instances;
};

}  // namespace engram::ltm
