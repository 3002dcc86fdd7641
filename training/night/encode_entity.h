// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ltm/store/latent.h"
#include "ltm/store/store_reader.h"
#include "training/forms/representation.h"
#include "training/night/encoding_limits.h"
#include "training/night/entity_work.h"
#include "training/night/kept_quality.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// Snapshots of an entity encoded with one model, and the quality of the decoded values compared
/// with the recorded ones.
struct EncodedEntity {
  int model_version = 0;
  size_t snapshots = 0;  ///< The first of those that were asked for: fewer if the time was over.
  std::vector<ltm::LatentSnapshot> latents;  ///< One per snapshot, without those already published.
  KeptQuality quality;
  double seconds = 0;  ///< Time of encoding, decoding and comparing.
};

/// The limits of encoding an entity that has so much time.
[[nodiscard]] EncodingLimits limits_of(const Allotment& time);

/// Encodes some snapshots of an entity with a model, each block in the cheapest form that
/// `representation` allows, then decodes them as in a query and compares. It ends early where the
/// limits demand it.
/// Errors: the errors of EntityEncoding::run.
Result<EncodedEntity> encode_entity(const EntityWork& work,
                                    const std::shared_ptr<encoders::DeepModel>& model, int version,
                                    std::span<const ltm::SnapshotEntry> entries,
                                    const RepresentationOptions& representation,
                                    const EncodingLimits& limits = {});

}  // namespace engram::training
