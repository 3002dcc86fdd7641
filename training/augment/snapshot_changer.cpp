// SPDX-License-Identifier: Apache-2.0
#include "training/augment/snapshot_changer.h"

#include <algorithm>

#include "augmentation/random.h"
#include "ltm/recall/store_conditions.h"
#include "ltm/store/manifest.h"

namespace engram::training {

namespace {

constexpr const char* kProvider = "augmentation";

std::string reason_of(const AugmentedEntity& report) {
  if (report.without_mask > 0) return "the entity of the mask has nothing at these moments";
  if (report.without_scene > 0) return "what was there at these moments is not known";
  return report.left_out > 0 ? "no recorded snapshot with images" : "no snapshot matches";
}

class Augmentation {
 public:
  Augmentation(ltm::StoreReader& reader, ltm::Recorder& recorder,
               const AugmentedStoreOptions& options, SnapshotChanger& changer,
               const ProgressSink& progress, const std::stop_token& stop)
      : reader_(reader),
        recorder_(recorder),
        options_(options),
        conditions_(reader.path(), options.query),
        changer_(changer),
        progress_(progress),
        stop_(stop) {}

  Result<AugmentedEntity> run(const ltm::MemoryId& entity) {
    AugmentedEntity report;
    report.entity = entity;
    report.skipped_reason = changer_.begin(entity);
    if (!report.skipped_reason.empty()) return report;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t total, timeline->count());
    ENGRAM_ASSIGN_OR_RETURN(
        auto cursor, datasets::SnapshotCursor::create(
                         *timeline, options_.query.snapshots_of(entity), conditions_.of(entity)));
    uint64_t seen = 0;
    while (!stop_.stop_requested()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto step, cursor.next());
      if (!step || step->is_future) break;
      ltm::EntityUpdate update{entity, step->entry.time, {}};
      ENGRAM_RETURN_IF_ERROR(changer_.change(*step, update, report));
      if (!update.instances.empty()) {
        ++report.snapshots;
        report.instances += update.instances.size();
        ENGRAM_RETURN_IF_ERROR(recorder_.commit({{std::move(update)}}));
      }
      if (progress_)
        progress_({"augment " + entity.to_string(), ++seen, total, to_string(step->entry.time)});
    }
    if (report.snapshots == 0) report.skipped_reason = reason_of(report);
    if (const auto counted = recorder_.counters().find(entity);
        counted != recorder_.counters().end())
      report.stored_bytes = counted->second.stored_bytes;
    return report;
  }

 private:
  ltm::StoreReader& reader_;
  ltm::Recorder& recorder_;
  const AugmentedStoreOptions& options_;
  ltm::StoreConditions conditions_;
  SnapshotChanger& changer_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
};

/// Integer division that rounds towards minus infinity, so that spans of time before 1970 are not
/// shifted.
int64_t floored(int64_t value, int64_t divisor) {
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

}  // namespace

Result<AugmentReport> make_augmented_store(ltm::StoreReader& from, const std::filesystem::path& to,
                                           const std::vector<ltm::MemoryId>& entities,
                                           const AugmentedStoreOptions& options,
                                           SnapshotChanger& changer, const ProgressSink& progress,
                                           const std::stop_token& stop) {
  // An existing store is refused, so that augmented snapshots never mix with recorded ones.
  if (!ltm::is_store_absent(to))
    return already_exists("'{}' is there already: needs a new place", to.string());
  ltm::Recorder::Options recording;
  recording.pack.image_codec = options.image_codec;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(to, recording));
  const ltm::SegmentTypes types = from.manifest().types.of_entities(entities);
  for (const auto& [segment, type] : types.all())
    ENGRAM_RETURN_IF_ERROR(recorder.declare(segment, type));
  Augmentation augmentation(from, recorder, options, changer, progress, stop);
  AugmentReport report;
  report.damaged_places = from.damaged_places();
  for (const ltm::MemoryId& entity : entities) {
    ENGRAM_ASSIGN_OR_RETURN(AugmentedEntity one, augmentation.run(entity));
    report.entities.push_back(std::move(one));
  }
  report.is_cancelled = stop.stop_requested();
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  return report;
}

Result<ltm::InstanceMetadata> augmented_metadata(const ltm::Snapshot& origin, int32_t instance,
                                                 const augmentation::Recipe& recipe) {
  ltm::InstanceMetadata metadata = origin.instances[static_cast<size_t>(instance)].metadata;
  metadata.provider = kProvider;
  metadata.origin = origin.id().instance(instance);
  ENGRAM_ASSIGN_OR_RETURN(metadata.recipe, recipe.to_text());
  return metadata;
}

std::vector<int32_t> asked_instances(const datasets::SnapshotCursor::Step& step, size_t count) {
  std::vector<int32_t> asked;
  for (int32_t i = 0; i < static_cast<int32_t>(count); ++i)
    if (step.instances.empty() || std::ranges::binary_search(step.instances, i)) asked.push_back(i);
  return asked;
}

uint64_t seed_of(uint64_t seed, SeedPurpose purpose, int copy, int64_t moment) {
  uint64_t mixed = augmentation::random_at(seed, static_cast<uint64_t>(purpose));
  mixed = augmentation::random_at(mixed, static_cast<uint64_t>(copy));
  return augmentation::random_at(mixed, static_cast<uint64_t>(moment));
}

int64_t part_of(Time time, Duration hold) {
  return floored(to_ns(time), std::max<int64_t>(1, hold.count()));
}

Result<std::vector<ltm::MemoryId>> entities_of(ltm::StoreReader& reader, const ltm::Query& query) {
  std::vector<ltm::MemoryId> entities;
  for (const ltm::MemoryId& entity : reader.entities())
    if (query.matches(entity)) entities.push_back(entity);
  if (entities.empty())
    return not_found("store '{}': none of its {} entities matches '{}'", reader.path().string(),
                     reader.entities().size(), query.to_string());
  return entities;
}

}  // namespace engram::training
