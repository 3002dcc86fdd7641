// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_writer.h"

#include <algorithm>
#include <cmath>

#include "ltm/h5/h5.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "ltm/store/checksum.h"
#include "ltm/store/media_sorter.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_errors.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_latents.h"
#include "ltm/store/segment_media.h"
#include "ltm/store/segment_rows.h"
#include "ltm/store/segment_tensors.h"
#include "ltm/store/shared_directory.h"
#include "ltm/store/shared_groups.h"

namespace engram::ltm {

namespace {

using h5::Storage;
using idf::Dict;

// A row without any error has an infinite PSNR, which would make every sum infinite.
constexpr double kPsnrCapDb = 60;

Status write_entity_header(h5::File& file, const std::string& group, const MemoryId& entity) {
  ENGRAM_RETURN_IF_ERROR(file.make_group(group));
  return file.write_attribute(group, "memory_id", entity.to_string());
}

/// Writes the rows of entities, one after the other, to a group.
Status write_recorded_rows(h5::File& file, const std::string& group,
                           std::span<const EntityRef> entities) {
  std::vector<SegmentRow> rows;
  for (const auto& [id, recorded] : entities)
    for (const PackedSnapshot& snapshot : recorded->snapshots)
      for (size_t i = 0; i < snapshot.instances.size(); ++i) rows.push_back({&snapshot, i});
  // Those that share a group have the same rules for what it holds.
  const SealRules& rules = entities.front().second->rules;
  const idf::Layout layout = most_common_layout(rows);
  ENGRAM_ASSIGN_OR_RETURN(const auto layout_bytes,
                          idf::encode(layout.to_data(), idf::kMaxDepth + idf::kContainerDepth));
  const uint64_t layout_size = layout_bytes.size();
  ENGRAM_RETURN_IF_ERROR(file.write(group + "/layout", h5::Type::kUInt8, {&layout_size, 1},
                                    layout_bytes, Storage::kCompressed));
  RowColumns columns;
  AccountingColumns accounting;
  TensorColumns tensors(layout, rows.size(), rules);
  RemainderColumn remainder;
  MediaSorter media(rules);
  for (size_t i = 0; i < rows.size(); ++i) {
    const PackedInstance& packed = rows[i].packed();
    columns.append(rows[i].snapshot->time, rows[i].instance, packed.metadata);
    accounting.append(rows[i]);
    // A row that does not fit the layout of most rows is kept whole in the remainder.
    auto parts = layout.split(packed.value.rest);
    if (parts.ok()) {
      tensors.set(i, parts->tensors);
      remainder.append(std::move(parts->remainder));
    } else {
      remainder.append(Dict{{"value", packed.value.rest}});
    }
    media.append(i, rows[i]);
  }
  ENGRAM_RETURN_IF_ERROR(columns.write(file, group));
  ENGRAM_RETURN_IF_ERROR(accounting.write(file, group));
  ENGRAM_RETURN_IF_ERROR(tensors.write(file, group));
  ENGRAM_RETURN_IF_ERROR(remainder.write(file, group + "/remainder"));
  ENGRAM_ASSIGN_OR_RETURN(const SortedMedia sorted, media.finish());
  return write_media(file, group, sorted, rows.size());
}

Status write_alone(h5::File& file, const EntityRef& entity) {
  const std::string group = segment_group(*entity.first);
  ENGRAM_RETURN_IF_ERROR(write_entity_header(file, group, *entity.first));
  return write_recorded_rows(file, group, {&entity, 1});
}

/// Writes the shared groups and the directory that tells where entities lie in them.
Status write_shared(h5::File& file, const std::vector<std::vector<EntityRef>>& groups) {
  std::vector<SharedEntity> all;
  for (size_t number = 0; number < groups.size(); ++number) {
    ENGRAM_RETURN_IF_ERROR(file.make_group(shared_group(number)));
    ENGRAM_RETURN_IF_ERROR(write_recorded_rows(file, shared_group(number), groups[number]));
    uint64_t first = 0;
    for (const auto& [id, recorded] : groups[number]) {
      const uint64_t rows = row_count_of(*recorded);
      all.push_back({*id, static_cast<int32_t>(number), first, rows});
      first += rows;
    }
  }
  std::ranges::sort(all, {}, &SharedEntity::id);
  return write_shared_directory(file, all);
}

/// Writes the types of the segment's entities, so that the file is self-describing.
Status write_types(h5::File& file, const SegmentInfo& info, const SegmentTypes& types) {
  std::vector<MemoryId> entities;
  for (const SegmentEntity& entity : info.entities) entities.push_back(entity.id);
  const SegmentTypes needed = types.of_entities(entities);
  if (needed.all().empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, idf::to_json_text(needed.to_data()));
  return file.write_strings(kSegmentTypes, {&text, 1});
}

Result<h5::File> create_segment(const std::filesystem::path& path, std::string_view kind,
                                int version = kFirstSegmentFormatVersion) {
  ENGRAM_ASSIGN_OR_RETURN(h5::File file, h5::File::create(path));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "format", "engram segment"));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "format_version", int64_t{version}));
  ENGRAM_RETURN_IF_ERROR(file.write_attribute("/", "kind", kind));
  return file;
}

/// Gives each entity its share of the bytes of the groups.
Status share_bytes(const h5::File& file, const GroupPlan& plan, SegmentInfo& info) {
  std::map<MemoryId, uint64_t> bytes;
  for (const auto& [id, recorded] : plan.alone) {
    ENGRAM_ASSIGN_OR_RETURN(bytes[*id], file.storage_bytes(segment_group(*id)));
  }
  for (size_t number = 0; number < plan.shared.size(); ++number) {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t all, file.storage_bytes(shared_group(number)));
    uint64_t rows = 0;
    for (const auto& [id, recorded] : plan.shared[number]) rows += row_count_of(*recorded);
    for (const auto& [id, recorded] : plan.shared[number])
      bytes[*id] = share_of(all, row_count_of(*recorded), rows);
  }
  for (SegmentEntity& entity : info.entities.edit()) entity.stored_bytes = bytes[entity.id];
  return {};
}

/// Closes the file and fills in sizes and checksum. The bytes of all entities add up to the size of
/// the file.
Status finish_segment(h5::File file, SegmentInfo& info) {
  const std::filesystem::path path = file.path();
  // HDF5 writes its last metadata on closing, so the size and checksum of the file are known only
  // then.
  ENGRAM_RETURN_IF_ERROR(file.close());
  info.bytes = std::filesystem::file_size(path);
  spread_overhead(info);
  ENGRAM_ASSIGN_OR_RETURN(info.checksum, checksum_of_file(path));
  return {};
}

SegmentEntity summarise(const MemoryId& id, const RecordedEntity& recorded) {
  SegmentEntity entity;
  entity.id = id;
  entity.snapshots = recorded.snapshots.size();
  entity.dropped = recorded.trailing_dropped;
  entity.dropped_bytes = recorded.trailing_dropped_bytes;
  if (!recorded.snapshots.empty()) {
    entity.first = recorded.snapshots.front().time;
    entity.last = recorded.snapshots.back().time;
  }
  for (const PackedSnapshot& snapshot : recorded.snapshots) {
    entity.rows += snapshot.instances.size();
    entity.raw_bytes += snapshot.raw_bytes;
    entity.augmented += snapshot.is_augmented() ? 1 : 0;
    entity.dropped += snapshot.dropped;
    entity.dropped_bytes += snapshot.dropped_bytes;
  }
  return entity;
}

}  // namespace

void spread_overhead(SegmentInfo& info) {
  uint64_t data_bytes = 0;
  for (const SegmentEntity& entity : info.entities) data_bytes += entity.stored_bytes;
  uint64_t overhead = info.bytes - std::min(info.bytes, data_bytes);
  uint64_t left = info.entities.size();
  for (SegmentEntity& entity : info.entities.edit()) {
    const uint64_t share = overhead / left--;
    entity.stored_bytes += share;
    overhead -= share;
  }
}

void add_to_sums(LatentSums& sums, const MeasuredError& error) {
  if (!std::isnan(error.image_mse)) {
    ++sums.image_rows;
    sums.image_mse += error.image_mse;
    sums.psnr_db += error.image_mse <= 0
                        ? kPsnrCapDb
                        : std::min(kPsnrCapDb, 10 * std::log10(255.0 * 255.0 / error.image_mse));
  }
  if (!std::isnan(error.number_mse)) {
    ++sums.number_rows;
    sums.number_mse += error.number_mse;
  }
}

Result<SegmentInfo> write_recorded_segment(const std::filesystem::path& file,
                                           const std::map<MemoryId, RecordedEntity>& entities,
                                           const SegmentTypes& types) {
  SegmentInfo info;
  info.kind = SegmentKind::kRecorded;
  const GroupPlan plan = plan_groups(entities);
  // Older programs read what they understand.
  const bool is_shared = !plan.shared.empty();
  ENGRAM_ASSIGN_OR_RETURN(h5::File segment, create_segment(file, "recorded",
                                                           is_shared ? kSegmentFormatVersion
                                                                     : kFirstSegmentFormatVersion));
  for (const EntityRef& entity : plan.alone) ENGRAM_RETURN_IF_ERROR(write_alone(segment, entity));
  if (is_shared) ENGRAM_RETURN_IF_ERROR(write_shared(segment, plan.shared));
  for (const auto& [id, recorded] : entities) info.entities.edit().push_back(summarise(id, recorded));
  ENGRAM_RETURN_IF_ERROR(share_bytes(segment, plan, info));
  ENGRAM_RETURN_IF_ERROR(write_types(segment, info, types));
  ENGRAM_RETURN_IF_ERROR(finish_segment(std::move(segment), info));
  return info;
}

Result<SegmentInfo> write_latent_segment(const std::filesystem::path& file, const MemoryId& entity,
                                         const std::vector<LatentSnapshot>& snapshots) {
  SegmentInfo info;
  info.kind = SegmentKind::kLatent;
  SegmentEntity& summary = info.entities.edit().emplace_back();
  summary.id = entity;
  ENGRAM_ASSIGN_OR_RETURN(h5::File segment, create_segment(file, "latent"));
  const std::string group = segment_group(entity);
  RowColumns columns;
  LatentCodeColumn codes;
  RemainderColumn remainder;
  ErrorColumns errors;
  for (const LatentSnapshot& snapshot : snapshots) {
    for (size_t i = 0; i < snapshot.instances.size(); ++i) {
      const LatentInstance& instance = snapshot.instances[i];
      columns.append(snapshot.time, i, instance.metadata);
      ENGRAM_RETURN_IF_ERROR(codes.append(instance.latent));
      remainder.append(instance.latent.remainder);
      errors.append(instance.quality);
      add_to_sums(summary.latent, instance.quality.error);
    }
  }
  ENGRAM_RETURN_IF_ERROR(write_entity_header(segment, group, entity));
  if (!snapshots.empty()) {
    summary.first = snapshots.front().time;
    summary.last = snapshots.back().time;
    summary.latent.model_version = snapshots.front().model_version;
  }
  ENGRAM_RETURN_IF_ERROR(
      segment.write_attribute(group, "model_version", int64_t{summary.latent.model_version}));
  ENGRAM_RETURN_IF_ERROR(columns.write(segment, group));
  ENGRAM_RETURN_IF_ERROR(codes.write(segment, group + "/latent"));
  ENGRAM_RETURN_IF_ERROR(remainder.write(segment, group + "/remainder"));
  ENGRAM_RETURN_IF_ERROR(errors.write(segment, group));
  summary.snapshots = snapshots.size();
  summary.rows = columns.rows();
  ENGRAM_ASSIGN_OR_RETURN(summary.stored_bytes, segment.storage_bytes(group));
  ENGRAM_RETURN_IF_ERROR(finish_segment(std::move(segment), info));
  return info;
}

}  // namespace engram::ltm
