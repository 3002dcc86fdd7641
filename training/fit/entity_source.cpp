// SPDX-License-Identifier: Apache-2.0
#include "training/fit/entity_source.h"

#include <algorithm>
#include <memory>

#include "encoders/tensor_plan.h"

namespace engram::training {

namespace {

/// Whether every instance has this layout.
bool fits(const ltm::Snapshot& snapshot, const idf::Layout& layout) {
  return !snapshot.instances.empty() &&
         std::ranges::all_of(snapshot.instances, [&](const auto& instance) {
           const auto parts = layout.split(instance.data);
           return parts.ok() && encoders::inexact_members(layout, *parts).empty();
         });
}

idf::Layout layout_of(const idf::Data& value, const idf::Type* type) {
  idf::Layout layout = idf::Layout::of(value);
  if (type != nullptr)
    layout = layout.with_kinds_of(idf::Layout::of(value, *type, idf::FreeSizes::kOfValue));
  const auto parts = layout.split(value);
  return layout.with_remainder(encoders::inexact_members(layout, *parts));
}

}  // namespace

Result<EntitySource> EntitySource::find(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                        size_t min, bool needs_news, const std::stop_token& stop) {
  EntitySource source;
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader.index(entity));
  std::vector<ltm::SnapshotEntry> recorded;
  bool has_news = false;
  for (const ltm::SnapshotEntry& entry : *index) {
    if (!entry.recorded || entry.recorded->rows == 0) continue;
    ENGRAM_ASSIGN_OR_RETURN(const bool is_augmented, reader.is_augmented(entity, entry));
    if (is_augmented) {
      ++source.augmented;
      continue;
    }
    recorded.push_back(entry);
    has_news = has_news || !entry.latent;
  }
  if (recorded.size() < min) {
    source.missing = fmt::format("{} recorded snapshots, needs {}", recorded.size(), min);
    if (source.augmented > 0)
      source.missing += fmt::format("; {} are augmented, which no model encodes", source.augmented);
    return source;
  }
  if (needs_news && !has_news) {
    source.missing = "nothing new";
    return source;
  }
  // To find the most frequent layout, all snapshots would have to be read. The newest layout is
  // used instead, because the next snapshots will have it too.
  ENGRAM_ASSIGN_OR_RETURN(const auto newest, reader.read_recorded(entity, recorded.back()));
  if (newest.instances.empty()) {
    source.missing = "the newest snapshot has no instance";
    return source;
  }
  source.layout =
      layout_of(newest.instances.front().data, reader.manifest().types.of_entity(entity));
  for (const ltm::SnapshotEntry& entry : recorded) {
    if (stop.stop_requested()) return cancelled("reading {} was stopped", entity.to_string());
    ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader.read_recorded(entity, entry));
    if (!fits(snapshot, source.layout)) {
      ++source.left_behind;
      continue;
    }
    source.entries.push_back(entry);
    source.new_snapshots += entry.latent ? 0 : 1;
    source.plain_bytes += snapshot.raw_bytes();
  }
  if (source.entries.size() < min)
    source.missing = fmt::format("{} recorded snapshots of the newest layout, needs {}",
                                 source.entries.size(), min);
  return source;
}

TrainingSource EntitySource::values(ltm::StoreReader& reader, const ltm::MemoryId& entity,
                                    const idf::Layout& layout,
                                    std::vector<ltm::SnapshotEntry> entries) {
  TrainingSource source;
  source.layout = layout;
  source.entity = entity.to_string();
  for (const ltm::SnapshotEntry& entry : entries) source.times.push_back(entry.time);
  const auto shared = std::make_shared<const std::vector<ltm::SnapshotEntry>>(std::move(entries));
  source.read = [&reader, &entity, shared](size_t i) -> Result<idf::Data> {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot, reader.read_recorded(entity, (*shared)[i]));
    return std::move(snapshot.instances.front().data);
  };
  return source;
}

}  // namespace engram::training
