// SPDX-License-Identifier: Apache-2.0
#include "training/night/encode_groups.h"

#include <utility>
#include <variant>

#include "training/night/entity_report.h"
#include "training/night/publish_entity.h"

namespace engram::training {

Result<OrSkipped<EntityReport>> encode_in_groups(const EntityWork& work,
                                                 const EncodedGroups& groups, const Allotment& time,
                                                 EntityReport report) {
  using Done = OrSkipped<EntityReport>;
  EncodingLimits limits = limits_of(time);
  limits.publish = groups.publish;
  limits.publish_interval = work.options.job.publish_interval;
  ENGRAM_ASSIGN_OR_RETURN(
      auto encoded, or_skipped(encode_entity(work, groups.model, groups.version, groups.entries,
                                             groups.representation, limits),
                               work.pace));
  if (auto* skipped = std::get_if<Skipped>(&encoded)) return Done(std::move(*skipped));
  const auto& done = std::get<EncodedEntity>(encoded);
  if (done.snapshots == 0 && !groups.entries.empty()) return Done(nothing_encoded());
  if (!done.latents.empty()) ENGRAM_RETURN_IF_ERROR(groups.publish(done.latents, done.quality));
  tell(done, groups.entries.size(), report);
  report.encoding_seconds = done.seconds;
  return Done(std::move(report));
}

Result<OrSkipped<EntityReport>> encode_with_newest(
    const EntityWork& work, const std::shared_ptr<encoders::DeepModel>& model,
    std::span<const ltm::SnapshotEntry> entries, const RepresentationOptions& representation,
    const Allotment& time, EntityReport report) {
  const ltm::ModelInfo& newest = *work.reader.manifest().newest_model(work.entity);
  const auto publish = [&](const auto& latents, const KeptQuality&) {
    return publish_more_latents(work, newest.version, latents);
  };
  report.model_bytes = newest.bytes;
  return encode_in_groups(work, {model, newest.version, entries, representation, publish}, time,
                          std::move(report));
}

}  // namespace engram::training
