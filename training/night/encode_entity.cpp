// SPDX-License-Identifier: Apache-2.0
#include "training/night/encode_entity.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <utility>

#include "training/night/entity_encoding.h"

namespace engram::training {

namespace {

void count_encoded(BlockChoice& choice, EntityCosts& costs) {
  costs.images_encoded += static_cast<uint64_t>(choice.counts().rows);
  for (const std::optional<int>& encodes : choice.video_encodes()) {
    if (encodes)
      costs.encodes.push_back(*encodes);
    else
      ++costs.known_videos;
  }
  if (choice.video_encodes().empty()) return;
  const VideoSearchOptions& search = choice.videos().search_of(0).options();
  costs.video = fmt::format("{}:{}", search.codec, search.settings);
}

}  // namespace

EncodingLimits limits_of(const Allotment& time) {
  EncodingLimits limits;
  limits.end = time.encoded_end;
  limits.seconds_per_snapshot = time.seconds_per_snapshot;
  return limits;
}

Result<EncodedEntity> encode_entity(const EntityWork& work,
                                    const std::shared_ptr<encoders::DeepModel>& model, int version,
                                    std::span<const ltm::SnapshotEntry> entries,
                                    const RepresentationOptions& representation,
                                    const EncodingLimits& limits) {
  const auto start = std::chrono::steady_clock::now();
  const auto decoder = encoders::make_encoder(model);
  EntityEncoding encoding(work.reader, work.entity, version, *model, *decoder, representation,
                          work.costs.stages);
  ENGRAM_RETURN_IF_ERROR(encoding.run(entries, work.pace, limits));
  count_encoded(encoding.choice(), work.costs);
  EncodedEntity encoded;
  encoded.model_version = version;
  encoded.snapshots = encoding.done();
  encoded.quality = encoding.quality();
  encoded.latents = std::move(encoding.latents());
  encoded.seconds = to_seconds(std::chrono::steady_clock::now() - start);
  return encoded;
}

}  // namespace engram::training
