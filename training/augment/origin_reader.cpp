// SPDX-License-Identifier: Apache-2.0
#include "training/augment/origin_reader.h"

#include <algorithm>

#include "training/augment/snapshot_changer.h"

namespace engram::training {

const idf::Type* OriginReader::type_of(const ltm::MemoryId& entity) const {
  return reader_.manifest().types.of_entity(entity);
}

Result<std::optional<Origin>> OriginReader::read(const ltm::MemoryId& entity,
                                                 const ltm::SnapshotEntry& entry,
                                                 Missing& missing) {
  missing = Missing::kImages;
  if (!entry.recorded) return std::optional<Origin>();
  Origin origin;
  ENGRAM_ASSIGN_OR_RETURN(origin.snapshot, reader_.read_recorded(entity, entry));
  const idf::Type* type = type_of(entity);
  const auto has_image = [&](const ltm::Instance& one) {
    return augmentation::has_images(idf::Layout::of(one.data)) ||
           (type != nullptr && augmentation::has_images(idf::Layout::of(one.data, *type)));
  };
  if (origin.snapshot.is_augmented() || !std::ranges::all_of(origin.snapshot.instances, has_image))
    return std::optional<Origin>();
  if (!options_.mask_entity) return std::optional(std::move(origin));
  missing = Missing::kMask;
  ENGRAM_ASSIGN_OR_RETURN(origin.labels, labels_at(origin.snapshot.time));
  return origin.labels ? std::optional(std::move(origin)) : std::nullopt;
}

/// The labels at exactly `time`; nothing if the entity of the mask has no snapshot then.
Result<std::optional<idf::NdArray>> OriginReader::labels_at(Time time) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(*options_.mask_entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_before(time));
  if (!entry || entry->time != time || !entry->recorded) return std::optional<idf::NdArray>();
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot found,
                          reader_.read_recorded(*options_.mask_entity, *entry));
  for (const ltm::Instance& instance : found.instances) {
    const idf::Layout layout = idf::Layout::of(instance.data);
    for (const idf::TensorMember& member : layout.members())
      if (member.kind == idf::MemberKind::kImage && member.shape[2] == 1)
        return std::optional(instance.data.at(member.path)->get<idf::NdArray>());
  }
  return invalid_argument("{}: found no uint8 or uint16 [H, W, 1] in it, needs one as the mask",
                          found.id().to_string());
}

std::vector<augmentation::ChangeChoice> choices_of(const AugmentOptions& options) {
  if (!options.changes.empty()) return options.changes;
  return augmentation::usual_changes(options.strength_percent,
                                     options.mask_entity || !options.members.labels.empty());
}

Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader,
                                               const AugmentOptions& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(auto entities, entities_of(reader, options.query));
  if (options.mask_entity) ENGRAM_RETURN_IF_ERROR(reader.timeline(*options.mask_entity).status());
  return entities;
}

}  // namespace engram::training
