// SPDX-License-Identifier: Apache-2.0
#include "training/augment/augment_store.h"

#include "training/augment/origin_reader.h"
#include "training/augment/snapshot_changer.h"

namespace engram::training {

namespace {

/// Changes recorded images by recipes.
class ImageChanger final : public SnapshotChanger {
 public:
  ImageChanger(ltm::StoreReader& reader, const AugmentOptions& options)
      : origins_(reader, options), options_(options) {}

  std::string begin(const ltm::MemoryId& entity) override {
    entity_ = entity;
    type_ = origins_.type_of(entity);
    return options_.mask_entity == entity ? "its images are the mask" : "";
  }

  Status change(const datasets::SnapshotCursor::Step& step, ltm::EntityUpdate& update,
                AugmentedEntity& report) override {
    OriginReader::Missing missing{};
    ENGRAM_ASSIGN_OR_RETURN(const auto found, origins_.read(entity_, step.entry, missing));
    if (!found) {
      ++report.left_out;
      report.without_mask += missing == OriginReader::Missing::kMask ? 1 : 0;
      return {};
    }
    for (int copy = 0; copy < options_.copies; ++copy)
      ENGRAM_RETURN_IF_ERROR(append(*found, step, copy, update));
    return {};
  }

 private:
  /// Adds one copy of all requested instances.
  Status append(const Origin& found, const datasets::SnapshotCursor::Step& step, int copy,
                ltm::EntityUpdate& update) {
    const ltm::Snapshot& origin = found.snapshot;
    const augmentation::Recipe recipe = recipe_at(options_, origin.time, copy);
    for (const int32_t i : asked_instances(step, origin.instances.size())) {
      auto data = augmentation::augmented(origin.instances[static_cast<size_t>(i)].data, type_,
                                          recipe, options_.members, found.labels);
      if (!data.ok()) return data.status().with_context(origin.id().instance(i).to_string());
      ENGRAM_ASSIGN_OR_RETURN(auto metadata, augmented_metadata(origin, i, recipe));
      update.instances.push_back({*std::move(data), std::move(metadata)});
    }
    return {};
  }

  OriginReader origins_;
  const AugmentOptions& options_;
  ltm::MemoryId entity_;
  const idf::Type* type_ = nullptr;  ///< Type of the current entity; may be null.
};

}  // namespace

augmentation::Recipe recipe_at(const AugmentOptions& options, Time time, int copy) {
  augmentation::Random random(
      seed_of(options.seed, SeedPurpose::kRecipe, copy, part_of(time, options.hold)));
  return augmentation::with_seed(
      augmentation::draw_recipe(choices_of(options), options.label, random),
      seed_of(options.seed, SeedPurpose::kNoise, copy, to_ns(time)));
}

Result<AugmentReport> augment_store(const std::filesystem::path& from,
                                    const std::filesystem::path& to, const AugmentOptions& options,
                                    const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(from));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, entities_of(*reader, options));
  ImageChanger changer(*reader, options);
  return make_augmented_store(*reader, to, entities, options, changer, progress, stop);
}

}  // namespace engram::training
