// SPDX-License-Identifier: Apache-2.0
#include "training/augment/augment_store.h"

#include <algorithm>

#include "datasets/export_walk.h"
#include "ltm/recording/recorder.h"
#include "ltm/store/manifest.h"
#include "training/augment/origin_reader.h"

namespace engram::training {

namespace {

constexpr const char* kProvider = "augmentation";

/// A seed for each purpose: the sequences have nothing in common.
enum class Purpose : uint64_t { kRecipe = 1, kNoise = 2 };

uint64_t seed_of(uint64_t seed, Purpose purpose, int copy, int64_t moment) {
  uint64_t mixed = augmentation::random_at(seed, static_cast<uint64_t>(purpose));
  mixed = augmentation::random_at(mixed, static_cast<uint64_t>(copy));
  return augmentation::random_at(mixed, static_cast<uint64_t>(moment));
}

/// Towards minus infinity.
int64_t floored(int64_t value, int64_t divisor) {
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

/// Walks over one store and writes the other.
class Augmentation {
 public:
  Augmentation(ltm::StoreReader& reader, ltm::Recorder& recorder, const AugmentOptions& options,
               const ProgressSink& progress, const std::stop_token& stop)
      : reader_(reader),
        origins_(reader, options),
        recorder_(recorder),
        options_(options),
        progress_(progress),
        stop_(stop) {}

  Status declare(const std::vector<ltm::MemoryId>& entities) {
    const ltm::SegmentTypes types = reader_.manifest().types.of_entities(entities);
    for (const auto& [segment, type] : types.all())
      ENGRAM_RETURN_IF_ERROR(recorder_.declare(segment, type));
    return {};
  }

  Result<AugmentedEntity> run(const ltm::MemoryId& entity) {
    AugmentedEntity report;
    report.entity = entity;
    if (options_.mask_entity == entity) {
      report.skipped_reason = "its images are the mask";
      return report;
    }
    type_ = origins_.type_of(entity);
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_.timeline(entity));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t total, timeline->count());
    ENGRAM_ASSIGN_OR_RETURN(
        auto walk, datasets::SnapshotWalk::create(*timeline, options_.query.snapshots_of(entity)));
    uint64_t seen = 0;
    while (!stop_.stop_requested()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto step, walk.next());
      if (!step || step->is_future) break;
      ENGRAM_RETURN_IF_ERROR(add(entity, *step, report));
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
  [[nodiscard]] std::string reason_of(const AugmentedEntity& report) const {
    if (report.without_mask > 0) return "the entity of the mask has nothing at these moments";
    return report.left_out > 0 ? "no recorded snapshot with images" : "no snapshot matches";
  }

  Status add(const ltm::MemoryId& entity, const datasets::SnapshotWalk::Step& step,
             AugmentedEntity& report) {
    OriginReader::Missing missing{};
    ENGRAM_ASSIGN_OR_RETURN(const auto found, origins_.read(entity, step.entry, missing));
    if (!found) {
      ++report.left_out;
      report.without_mask += missing == OriginReader::Missing::kMask ? 1 : 0;
      return {};
    }
    const ltm::Snapshot& origin = found->snapshot;
    ltm::EntityUpdate update{entity, origin.time, {}};
    for (int copy = 0; copy < options_.copies; ++copy)
      ENGRAM_RETURN_IF_ERROR(append(origin, step.instances, found->labels, copy, update));
    ++report.snapshots;
    report.instances += update.instances.size();
    return recorder_.commit({{std::move(update)}});
  }

  /// Adds one copy of all instances that are asked for.
  Status append(const ltm::Snapshot& origin, const std::vector<int32_t>& asked,
                const std::optional<idf::NdArray>& labels, int copy, ltm::EntityUpdate& update) {
    const augmentation::Recipe recipe = recipe_at(options_, origin.time, copy);
    for (size_t i = 0; i < origin.instances.size(); ++i) {
      const auto index = static_cast<int32_t>(i);
      if (!asked.empty() && !std::ranges::binary_search(asked, index)) continue;
      const ltm::MemoryId id = origin.id().instance(index);
      auto data = augmentation::augmented(origin.instances[i].data, type_, recipe, options_.members,
                                          labels);
      if (!data.ok()) return data.status().with_context(id.to_string());
      ltm::InstanceMetadata metadata = origin.instances[i].metadata;
      metadata.provider = kProvider;
      metadata.origin = id;
      ENGRAM_ASSIGN_OR_RETURN(metadata.recipe, recipe.to_text());
      update.instances.push_back({*std::move(data), std::move(metadata)});
    }
    return {};
  }

  ltm::StoreReader& reader_;
  OriginReader origins_;
  ltm::Recorder& recorder_;
  const AugmentOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  const idf::Type* type_ = nullptr;  ///< Of the entity at hand; may be null.
};

}  // namespace

Status AugmentOptions::validate() const {
  if (query.is_ids_only())
    return invalid_argument("query '{}' asks for IDs alone: needs data", query.to_string());
  if (copies < 1 || copies > kMostCopies)
    return invalid_argument("copies: found {}, needs 1 to {}", copies, kMostCopies);
  if (strength_percent < 1 || strength_percent > 100)
    return invalid_argument("strength: found {}, needs 1 to 100", strength_percent);
  if (hold < Duration::zero())
    return invalid_argument("time that a recipe holds: found {}, needs 0 or more", to_string(hold));
  if (label < 0 || label > 65535)
    return invalid_argument("label: found {}, needs 0 (any) to 65535", label);
  if (mask_entity && !mask_entity->is_entity())
    return invalid_argument("mask '{}' is no entity: needs four names", mask_entity->to_string());
  for (const augmentation::ChangeChoice& choice : changes)
    if (choice.kind->needs_mask() && !mask_entity && members.labels.empty())
      return invalid_argument("change '{}': needs to be told where the object is (a mask)",
                              choice.kind->name());
  return {};
}

augmentation::Recipe recipe_at(const AugmentOptions& options, Time time, int copy) {
  const int64_t hold = std::max<int64_t>(1, options.hold.count());
  const int64_t part = floored(to_ns(time), hold);
  augmentation::Random random(seed_of(options.seed, Purpose::kRecipe, copy, part));
  return augmentation::with_seed(
      augmentation::draw_recipe(choices_of(options), options.label, random),
      seed_of(options.seed, Purpose::kNoise, copy, to_ns(time)));
}

Result<AugmentReport> augment_store(const std::filesystem::path& from,
                                    const std::filesystem::path& to, const AugmentOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(from));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, entities_of(*reader, options));
  if (!ltm::is_store_absent(to))
    return already_exists("'{}' is there already: needs a new place", to.string());
  ltm::Recorder::Options recording;
  recording.pack.image_codec = options.image_codec;
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(to, recording));
  Augmentation augmentation(*reader, recorder, options, progress, stop);
  ENGRAM_RETURN_IF_ERROR(augmentation.declare(entities));
  AugmentReport report;
  report.damaged_places = reader->damaged_places();
  for (const ltm::MemoryId& entity : entities) {
    ENGRAM_ASSIGN_OR_RETURN(AugmentedEntity one, augmentation.run(entity));
    report.entities.push_back(std::move(one));
  }
  report.is_cancelled = stop.stop_requested();
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  return report;
}

}  // namespace engram::training
