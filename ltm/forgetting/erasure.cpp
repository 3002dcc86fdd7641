// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/erasure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ltm/core/file.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/orphans.h"
#include "ltm/store/segment_index.h"
#include "ltm/store/store_writer.h"

namespace engram::ltm {

namespace {

using Json = nlohmann::ordered_json;

/// Whether an instance was made of one of a snapshot that goes.
bool is_made_of(const InstanceMetadata& instance, const ForgetSet& gone) {
  const MemoryId& origin = instance.origin;
  if (!origin.time() || !origin.has_entity()) return false;
  const auto times = gone.find(origin.entity());
  return times != gone.end() && times->second.contains(*origin.time());
}

template <typename Instances>
bool is_any_made_of(const Instances& instances, const ForgetSet& gone) {
  return std::ranges::any_of(
      instances, [&gone](const auto& instance) { return is_made_of(instance.metadata, gone); });
}

Result<bool> is_made_of(StoreReader& reader, const MemoryId& entity, const SnapshotEntry& entry,
                        const ForgetSet& gone) {
  if (entry.recorded && entry.recorded->rows > 0) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, reader.read_packed(entity, entry));
    return is_any_made_of(packed.instances, gone);
  }
  if (!entry.latent) return false;
  ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, reader.read_latent(entity, entry));
  return is_any_made_of(latents.instances, gone);
}

/// Whether any snapshot of the entity may be augmented. Latents are not counted.
bool may_be_augmented(const Manifest& manifest, const MemoryId& entity) {
  return std::ranges::any_of(manifest.segments, [&entity](const SegmentInfo& segment) {
    const SegmentEntity* part = segment.find(entity);
    return part != nullptr && (part->augmented > 0 || segment.kind == SegmentKind::kLatent);
  });
}

Json psnr_json(double db) {
  return std::isfinite(db) ? Json(db) : Json();
}

}  // namespace

void ErasureReport::add(const Erasures& later) {
  for (const auto& [id, entity] : later) {
    EntityErasure& sum = entities[id];
    sum.erased += entity.erased;
    sum.recoded += entity.recoded;
    sum.uncoded += entity.uncoded;
    sum.copied += entity.copied;
    sum.expected_db = std::min(sum.expected_db, entity.expected_db);
    sum.certain_db = std::min(sum.certain_db, entity.certain_db);
    sum.models.insert(sum.models.end(), entity.models.begin(), entity.models.end());
    sum.redacted_days.insert(entity.redacted_days.begin(), entity.redacted_days.end());
    sum.is_waiting = sum.is_waiting || entity.is_waiting;
  }
}

Json ErasureReport::to_json() const {
  Json list = Json::array();
  for (const auto& [id, entity] : entities) {
    list.push_back({{"id", id.to_string()},
                    {"erased", entity.erased},
                    {"coded_anew", entity.recoded},
                    {"to_code_anew", entity.uncoded},
                    {"copied", entity.copied},
                    {"expected_psnr", psnr_json(entity.expected_db)},
                    {"certain_psnr", psnr_json(entity.certain_db)},
                    {"models_removed", entity.models},
                    {"waits_for_consolidation", entity.is_waiting}});
    if (!entity.redacted_days.empty()) list.back()["redacted_days"] = entity.redacted_days;
  }
  return {{"entities", std::move(list)}, {"files_removed", files}};
}

bool is_made_of(const Snapshot& snapshot, const ForgetSet& gone) {
  return is_any_made_of(snapshot.instances, gone);
}

Status seal_before_erasing(const std::filesystem::path& store) {
  // As small as it may be: erasing must be possible on a full disk, too.
  ENGRAM_ASSIGN_OR_RETURN(const auto writer, StoreWriter::open(store, {.min_free_bytes = 0}));
  return writer->seal();
}

Status add_made_of(StoreReader& reader, ForgetPlan& plan) {
  ForgetSet gone = plan.to_set();
  for (bool is_changed = !gone.empty(); is_changed;) {
    is_changed = false;
    for (const MemoryId& entity : reader.entities()) {
      if (!may_be_augmented(reader.manifest(), entity)) continue;
      EntityForgetPlan& part = plan.entities[entity];
      ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
      ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const SnapshotEntry& entry) -> Status {
        ENGRAM_ASSIGN_OR_RETURN(const bool goes, is_made_of(reader, entity, entry, gone));
        if (!goes || !gone[entity].insert(entry.time)) return {};
        part.gone.insert(entry.time);
        part.stays -= std::min<uint64_t>(part.stays, 1);
        ++part.reasons["made of what goes"];
        is_changed = true;
        return {};
      }));
    }
  }
  return {};
}

Status note_what_is_left(StoreReader& reader, ForgetPlan& plan) {
  uint64_t coded = 0;
  size_t models = 0;
  for (const auto& planned : plan.entities) {
    const MemoryId& entity = planned.first;
    const EntityForgetPlan& part = planned.second;
    if (part.gone.empty() || !reader.has(entity)) continue;
    const auto& manifest = reader.manifest();
    models += static_cast<size_t>(std::ranges::count(manifest.models, entity, &ModelInfo::entity));
    const bool has_latents = std::ranges::any_of(manifest.segments, [&](const auto& segment) {
      return segment.kind == SegmentKind::kLatent && segment.find(entity) != nullptr;
    });
    if (!has_latents) continue;
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, reader.timeline(entity));
    ENGRAM_RETURN_IF_ERROR(
        timeline->for_each(part.gone.front(), part.gone.back(), [&](const SnapshotEntry& entry) {
          if (entry.latent && part.gone.contains(entry.time)) ++coded;
          return Status();
        }));
  }
  if (coded > 0)
    plan.notes.push_back(fmt::format(
        "{} of them are coded together with others. Those that share a block with snapshots that "
        "stay can still be decoded from the files until these go, too; --erase codes the blocks "
        "anew",
        coded));
  if (models > 0)
    plan.notes.push_back(fmt::format(
        "{} model{} may have learned from them, and stay{} until a night replaces {}; --erase "
        "removes those that did",
        models, models == 1 ? "" : "s", models == 1 ? "s" : "", models == 1 ? "it" : "them"));
  return {};
}

Result<std::vector<std::string>> remove_side_files(const std::filesystem::path& store,
                                                   const Erasures& erased) {
  std::vector<std::string> files;
  // Whoever publishes a file holds the lock of the manifest, so none that is just being published
  // is taken for one that was left over.
  ENGRAM_RETURN_IF_ERROR(edit_manifest(store, [&](Manifest&) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const auto orphans, find_orphans(store));
    for (const Finding& orphan : orphans) {
      const std::string name = std::filesystem::path(orphan.file).filename().string();
      const bool is_of_erased = std::ranges::any_of(
          erased, [&name](const auto& one) { return is_checkpoint_of(name, one.first); });
      if (!is_checkpoint(name) || is_of_erased) files.push_back(orphan.file);
    }
    return {};
  }));
  for (const std::string& file : files) ENGRAM_RETURN_IF_ERROR(remove_file(store / file));
  for (const auto& [id, entity] : erased) {
    // Those that a killed job had not finished, too.
    ENGRAM_RETURN_IF_ERROR(remove_checkpoints(store, id));
    ENGRAM_ASSIGN_OR_RETURN(auto indexes, remove_entity_indexes(store, id));
    std::ranges::move(indexes, std::back_inserter(files));
  }
  ENGRAM_ASSIGN_OR_RETURN(auto outdated, remove_outdated_entity_indexes(store));
  std::ranges::move(outdated, std::back_inserter(files));
  return files;
}

Status write_erasure_report(const std::filesystem::path& store, Time when, ErasureReport& report) {
  std::error_code failed;
  std::filesystem::create_directories(store / kErasureFolder, failed);
  if (failed) return unavailable("'{}': {}", (store / kErasureFolder).string(), failed.message());
  int number = 1;
  const auto name_of = [](int n) { return fmt::format("{}/{:06}.json", kErasureFolder, n); };
  while (std::filesystem::exists(store / name_of(number), failed)) ++number;
  Json json{{"when", to_string(when)}, {"when_ns", to_ns(when)}};
  json.update(report.to_json());
  const std::string text = json.dump(2) + "\n";
  ENGRAM_RETURN_IF_ERROR(
      replace_file(store / name_of(number), std::as_bytes(std::span(text.data(), text.size()))));
  report.report = name_of(number);
  return {};
}

}  // namespace engram::ltm
