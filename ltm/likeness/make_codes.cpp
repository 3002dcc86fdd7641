// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/make_codes.h"

#include <algorithm>
#include <map>

#include "ltm/core/log.h"
#include "ltm/likeness/gather_space.h"
#include "ltm/likeness/seen_image.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/recall/store_past.h"
#include "ltm/store/segment_index.h"

namespace engram::ltm {

namespace {

/// The space that is there, if it may still be used for an entity of so many snapshots.
std::optional<LikenessSpace> usable_space(StoreReader& store, const MemoryId& entity,
                                          size_t snapshots) {
  auto space = read_space(store, entity);
  if (space && snapshots >= 2 * space->snapshots) space.reset();
  return space;
}

/// Replaces the codes of one entity in a segment's index.
Status store_codes(StoreReader& store, uint32_t segment, const EntityCodes& codes) {
  const Status stored = edit_segment_index(
      store.path(), store.manifest().segments[segment], kCodesIndex,
      [&codes](std::span<const std::byte> there) {
        SegmentCodes all;
        if (auto known = unpack_codes(there); known.ok()) all = *std::move(known);
        std::erase_if(all, [&codes](const EntityCodes& one) { return one.entity == codes.entity; });
        all.push_back(codes);
        return pack_codes(all);
      });
  // It was replaced meanwhile, and the next job codes what replaced it.
  return stored.code() == StatusCode::kNotFound ? Status() : stored;
}

/// Codes one entity.
class Coding {
 public:
  Coding(StorePast& past, const MemoryId& entity, const CodesOptions& options,
         const ProgressSink& progress, const std::stop_token& stop)
      : past_(past), entity_(entity), options_(options), progress_(progress), stop_(stop) {
    report.entity = entity;
  }

  /// Does nothing if the entity has no images.
  Status run() {
    ENGRAM_ASSIGN_OR_RETURN(const auto* const found, past_.store().index(entity_));
    const std::vector<SnapshotEntry>& entries = *found;
    if (entries.size() < kMinCodedSnapshots) return {};
    ENGRAM_ASSIGN_OR_RETURN(images_, past_.of(entity_));
    ENGRAM_ASSIGN_OR_RETURN(const auto example, see(*images_, entries.back().time));
    if (!example) return {};
    has_images = true;
    const Status learned = find_space(entries);
    if (learned.code() == StatusCode::kCancelled && !stop_.stop_requested()) {
      report.left = entries.size();  // The time was over; the next job learns.
      return {};
    }
    ENGRAM_RETURN_IF_ERROR(learned);
    return code(entries);
  }

  EntityCoding report;
  bool has_images = false;

 private:
  Status find_space(const std::vector<SnapshotEntry>& entries) {
    if (auto there = usable_space(past_.store(), entity_, entries.size())) {
      space_ = *std::move(there);
    } else {
      std::vector<Time> times;
      times.reserve(entries.size());
      for (const SnapshotEntry& entry : entries) times.push_back(entry.time);
      ENGRAM_ASSIGN_OR_RETURN(
          space_, learn_space(past_, entity_, times, progress_, [this] { return is_over(); }));
      ENGRAM_RETURN_IF_ERROR(publish_entity_index(past_.store().path(), past_.store().manifest(),
                                                  entity_, kSpaceIndex, space_.pack()));
      report.is_learned = true;
    }
    report.space = space_.name();
    return {};
  }

  Status code(const std::vector<SnapshotEntry>& entries) {
    const uint64_t id = space_.id();
    const StoredCodes stored = StoredCodes::read(past_.store(), entity_, id);
    std::map<uint32_t, EntityCodes> made;
    std::map<uint32_t, bool> is_changed;
    Status failed;
    for (const SnapshotEntry& entry : entries) {
      const auto segment = segment_of_code(entry);
      if (!segment) continue;
      EntityCodes& codes =
          made.try_emplace(*segment, EntityCodes{entity_, id, {}, {}}).first->second;
      if (const auto there = stored.find(entry); !there.empty()) {
        is_changed[*segment] |= stored.find_in(*segment, entry.time).empty();
        codes.append(entry.time, there);
        ++report.kept;
        continue;
      }
      if (is_over()) {
        ++report.left;
        continue;
      }
      if (progress_)
        progress_({"code images of " + entity_.to_string(), report.coded + report.kept,
                   entries.size(), "", -1});
      failed = add(entry.time, codes);
      if (!failed.ok()) break;
      is_changed[*segment] = true;
    }
    if (progress_ && report.coded > 0 && report.left == 0)
      progress_({"code images of " + entity_.to_string(), entries.size(), entries.size(), "", -1});
    for (auto& [segment, codes] : made)
      if (is_changed[segment] && !codes.times.empty())
        ENGRAM_RETURN_IF_ERROR(store_codes(past_.store(), segment, codes));
    if (stop_.stop_requested()) return cancelled("'{}': coding its images", entity_.to_string());
    return failed;
  }

  bool is_over() const {
    return stop_.stop_requested() || (options_.is_over && options_.is_over());
  }

  Status add(Time time, EntityCodes& codes) {
    ENGRAM_ASSIGN_OR_RETURN(const auto seen, see(*images_, time));
    if (!seen || seen->size != space_.size) {
      ++report.skipped;
      return {};
    }
    codes.append(time, space_.code(seen->descriptor));
    ++report.coded;
    return {};
  }

  StorePast& past_;
  const MemoryId& entity_;
  const CodesOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::unique_ptr<EntityPast> images_;
  LikenessSpace space_;
};

/// Entities with enough snapshots in segments to be worth looking at.
std::vector<MemoryId> candidates(StoreReader& store) {
  std::map<MemoryId, uint64_t> snapshots;
  for (const SegmentInfo& segment : store.manifest().segments)
    for (const SegmentEntity& entity : segment.entities) snapshots[entity.id] += entity.snapshots;
  std::vector<MemoryId> entities;
  for (const auto& [entity, count] : snapshots)
    if (count >= kMinCodedSnapshots) entities.push_back(entity);
  return entities;
}

}  // namespace

Result<std::vector<EntityCoding>> make_codes(const std::filesystem::path& store,
                                             const ModelLoader& loader, const CodesOptions& options,
                                             const ProgressSink& progress,
                                             const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(store, loader, {}));
  std::vector<EntityCoding> report;
  for (const MemoryId& entity : candidates(past->store())) {
    if (options.matches && !options.matches(entity)) continue;
    if (options.is_over && options.is_over()) break;
    Coding coding(*past, entity, options, progress, stop);
    const Status coded = coding.run();
    if (coding.has_images) report.push_back(coding.report);
    if (coded.ok()) continue;
    if (coded.code() == StatusCode::kCancelled || coded.code() == StatusCode::kResourceExhausted)
      return coded;
    log::warning("store '{}': images of '{}' have no codes: {}", store.string(), entity.to_string(),
                 coded.message());
  }
  return report;
}

}  // namespace engram::ltm
