// SPDX-License-Identifier: Apache-2.0
#include "training/night/encode_entity.h"

#include <chrono>
#include <utility>

#include "training/night/entity_encoding.h"

namespace engram::training {

Result<EncodedEntity> encode_entity(const EntityWork& work,
                                    const std::shared_ptr<encoders::DeepModel>& model, int version,
                                    std::span<const ltm::SnapshotEntry> entries,
                                    const RepresentationOptions& representation) {
  const auto start = std::chrono::steady_clock::now();
  const auto decoder = encoders::make_encoder(model);
  EntityEncoding encoding(work.reader, work.entity, version, *model, *decoder, representation);
  ENGRAM_RETURN_IF_ERROR(encoding.run(entries, work.pace));
  EncodedEntity encoded;
  encoded.model_version = version;
  encoded.quality = encoding.quality();
  encoded.latents = std::move(encoding.latents());
  encoded.seconds = to_seconds(std::chrono::steady_clock::now() - start);
  return encoded;
}

}  // namespace engram::training
