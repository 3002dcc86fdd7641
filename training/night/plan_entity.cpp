// SPDX-License-Identifier: Apache-2.0
#include "training/night/plan_entity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "training/fit/entity_source.h"
#include "training/forms/noise_floor.h"
#include "training/night/entity_images.h"

namespace engram::training {

namespace {

/// Number of pairs of consecutive images on which noise is measured.
constexpr size_t kNoisePairs = 32;

bool has_images(const idf::Layout& layout) {
  return std::ranges::any_of(
      layout.members(), [](const auto& member) { return member.kind == idf::MemberKind::kImage; });
}

/// Sets the bound from the noise of the entity's own images. The pairs are spread over all
/// recordings, because noise depends on light and place.
Status choose_bound_by_noise(const EntityWork& work, PlannedEntity& planned) {
  NoiseFloor floor;
  const auto& entries = planned.entries;
  const size_t step = std::max<size_t>(1, entries.size() / kNoisePairs);
  for (size_t i = 0; i + 1 < entries.size(); i += step) {
    MemberImages images;
    for (const size_t at : {i, i + 1})
      ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entries[at], images));
    for (const auto& pair : images) ENGRAM_RETURN_IF_ERROR(floor.add(pair[0], pair[1]));
  }
  RepresentationOptions& representation = planned.representation;
  representation.noise_images = floor.images();
  representation.noise = floor.deviation().value_or(0);
  representation.bound_db = bound_of_noise(representation.noise);
  return {};
}

Status choose_bound(const EntityWork& work, PlannedEntity& planned) {
  RepresentationOptions& representation = planned.representation;
  if (!has_images(planned.layout)) {
    // Numbers have only one form.
    representation.kind = Representation::kLatents;
    return {};
  }
  if (representation.bound_db == 0) ENGRAM_RETURN_IF_ERROR(choose_bound_by_noise(work, planned));
  if (representation.kind != Representation::kLatents)
    planned.plan.bound = {representation.bound_db, representation.noise_images,
                          representation.noise};
  return {};
}

}  // namespace

bool PlannedEntity::has_images_alone() const {
  return std::ranges::all_of(layout.members(), [](const idf::TensorMember& member) {
    return member.kind == idf::MemberKind::kImage;
  });
}

bool PlannedEntity::compares_models(const ConsolidateOptions& options) const {
  return options.representation.kind == Representation::kAuto || !has_images(layout);
}

double PlannedEntity::weight() const {
  return is_skipped() ? 0 : std::sqrt(plain_bytes);
}

Result<PlannedEntity> plan_entity(const EntityWork& work) {
  const auto stage = work.stage(Stage::kPlan);
  PlannedEntity planned;
  planned.representation = work.options.representation;
  planned.representation.threads = work.options.train.threads;
  EntityPlan& plan = planned.plan;
  plan.entity = work.entity;
  ENGRAM_ASSIGN_OR_RETURN(const auto summary, work.reader.summary(work.entity));
  plan.stored_bytes = summary.stored_bytes;
  planned.plain_bytes = static_cast<double>(summary.raw_bytes);
  describe_newest_model(work.reader.manifest(), plan);
  ENGRAM_ASSIGN_OR_RETURN(EntitySource found,
                          EntitySource::find(work.reader, work.entity, work.options.min_snapshots,
                                             !work.options.force, work.pace.stop()));
  planned.left_behind = found.left_behind;
  plan.snapshots = found.entries.size();
  plan.new_snapshots = found.new_snapshots;
  plan.plain_bytes = found.plain_bytes;
  plan.skipped_reason = std::move(found.missing);
  planned.entries = std::move(found.entries);
  planned.layout = std::move(found.layout);
  if (!planned.is_skipped()) ENGRAM_RETURN_IF_ERROR(choose_bound(work, planned));
  return planned;
}

}  // namespace engram::training
