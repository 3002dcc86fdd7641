// SPDX-License-Identifier: Apache-2.0
#include "training/augment/change_examples.h"

#include "training/augment/origin_reader.h"

namespace engram::training {

namespace {

/// Max number of snapshots that are tried, from the newest on.
constexpr int kMaxTried = 100;

/// The newest origin of an entity, if there is one.
Result<std::optional<Origin>> newest_of(ltm::StoreReader& store, OriginReader& origins,
                                        const ltm::MemoryId& entity) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, store.timeline(entity));
  std::optional<Time> at = timeline->last();
  for (int tried = 0; at && tried < kMaxTried; ++tried) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_before(*at));
    if (!entry) break;
    OriginReader::Missing missing{};
    ENGRAM_ASSIGN_OR_RETURN(auto origin, origins.read(entity, *entry, missing));
    if (origin) return origin;
    at = time_from_ns(to_ns(entry->time) - 1);
  }
  return std::optional<Origin>();
}

}  // namespace

Result<std::vector<ChangeExample>> change_examples(const std::filesystem::path& store,
                                                   const AugmentOptions& options, size_t each) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, entities_of(*reader, options));
  OriginReader origins(*reader, options);
  for (const ltm::MemoryId& entity : entities) {
    if (entity == options.mask_entity) continue;
    ENGRAM_ASSIGN_OR_RETURN(const auto origin, newest_of(*reader, origins, entity));
    if (!origin) continue;
    std::vector<ChangeExample> examples;
    for (const augmentation::ChangeChoice& choice : choices_of(options)) {
      const idf::Data& before = origin->snapshot.instances.front().data;
      ChangeExample& example =
          examples.emplace_back(ChangeExample{std::string(choice.kind->name()), before, {}});
      augmentation::Random random(options.seed);
      while (example.after.size() < each) {
        const augmentation::Recipe recipe =
            augmentation::draw_recipe({&choice, 1}, options.label, random);
        ENGRAM_ASSIGN_OR_RETURN(example.after.emplace_back(),
                                augmentation::augmented(before, origins.type_of(entity), recipe,
                                                        options.members, origin->labels));
      }
    }
    return examples;
  }
  return not_found("store '{}': found no recorded snapshot with images that matches '{}'",
                   store.string(), options.query.to_string());
}

}  // namespace engram::training
