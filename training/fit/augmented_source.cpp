// SPDX-License-Identifier: Apache-2.0
#include "training/fit/augmented_source.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "augmentation/augment.h"
#include "ltm/store/checksum.h"
#include "ltm/store/store_reader.h"
#include "ltm/core/sequences.h"

namespace engram::training {

namespace {

/// One augmented instance of a store.
struct Found {
  ltm::SnapshotEntry entry;
  size_t instance = 0;
  size_t origin = 0;  ///< Index into the times of the source.
  augmentation::Recipe recipe;
};

/// The part of a recipe that consecutive values share: everything except the seed of its noise.
augmentation::Recipe shared_part(const std::string& text) {
  auto recipe = augmentation::Recipe::parse(text);
  // A recipe in another format is valid for one snapshot only.
  return recipe.ok() ? augmentation::with_seed(*std::move(recipe), 0) : augmentation::Recipe{};
}

/// Collects the augmented instances of an entity as runs.
class Collector {
 public:
  Collector(ltm::StoreReader& reader, const ltm::MemoryId& entity, const TrainingSource& source)
      : reader_(reader), entity_(entity), store_(reader.path().string()) {
    for (size_t i = 0; i < source.times.size(); ++i) origins_.emplace(source.times[i], i);
    for (const Sequence& recording : cut_sequences(source.times)) starts_.insert(recording.first);
  }

  Status add(const ltm::SnapshotEntry& entry) {
    if (!entry.recorded) return {};
    ENGRAM_ASSIGN_OR_RETURN(const ltm::PackedSnapshot packed, reader_.read_packed(entity_, entry));
    if (!packed.is_augmented())
      return invalid_argument("store '{}': {} is not augmented, needs a store that 'augment' made",
                              store_, entity_.at(entry.time).to_string());
    for (size_t i = 0; i < packed.instances.size(); ++i)
      add(entry, i, packed.instances[i].metadata);
    return {};
  }

  /// All runs, sorted by copy.
  [[nodiscard]] std::vector<std::vector<Found>> runs() && {
    std::vector<std::vector<Found>> all;
    for (auto& [copy, runs] : copies_) std::ranges::move(runs, std::back_inserter(all));
    return all;
  }

  [[nodiscard]] size_t left_out() const { return left_out_; }
  [[nodiscard]] uint64_t identity() const { return ltm::checksum(as_bytes(names_)); }

 private:
  void add(const ltm::SnapshotEntry& entry, size_t instance,
           const ltm::InstanceMetadata& metadata) {
    const ltm::MemoryId& from = metadata.origin;
    // Only the first instance of a snapshot is trained on.
    const bool is_of_entity = from.has_entity() && from.time() && from.entity() == entity_ &&
                              from.index().value_or(0) == 0;
    const auto origin = is_of_entity ? origins_.find(*from.time()) : origins_.end();
    if (origin == origins_.end()) {
      ++left_out_;
      return;
    }
    names_ += fmt::format("{} {} {} {}\n", to_ns(entry.time), instance, to_ns(*from.time()),
                          metadata.recipe);
    Found found{entry, instance, origin->second, shared_part(metadata.recipe)};
    auto& runs = copies_[instance];
    const bool goes_on = !runs.empty() && !starts_.contains(found.origin) &&
                         runs.back().back().origin + 1 == found.origin &&
                         !found.recipe.changes.empty() && runs.back().back().recipe == found.recipe;
    if (!goes_on) runs.emplace_back();
    runs.back().push_back(std::move(found));
  }

  ltm::StoreReader& reader_;
  const ltm::MemoryId& entity_;
  std::string store_;
  std::map<Time, size_t> origins_;
  std::set<size_t> starts_;                                   ///< First indices of recordings.
  std::map<size_t, std::vector<std::vector<Found>>> copies_;  ///< By index of the instance.
  size_t left_out_ = 0;
  std::string names_;  ///< The text that identifies these values.
};

}  // namespace

Result<AugmentedValues> find_augmented(const std::filesystem::path& store,
                                       const ltm::MemoryId& entity, const TrainingSource& source,
                                       const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(auto opened, ltm::StoreReader::open(store));
  const std::shared_ptr<ltm::StoreReader> reader = std::move(opened);
  const auto known = reader->timeline(entity);
  if (known.status().code() == StatusCode::kNotFound) return AugmentedValues{};
  ENGRAM_RETURN_IF_ERROR(known.status());
  ltm::Timeline* timeline = *known;
  Collector collector(*reader, entity, source);
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const ltm::SnapshotEntry& entry) -> Status {
    if (stop.stop_requested()) return cancelled("reading {} was stopped", entity.to_string());
    return collector.add(entry);
  }));
  AugmentedValues values;
  values.left_out = collector.left_out();
  values.identity = collector.identity();
  const auto runs =
      std::make_shared<const std::vector<std::vector<Found>>>(std::move(collector).runs());
  for (const auto& run : *runs) {
    std::vector<size_t>& origins = values.origins.emplace_back();
    for (const Found& found : run) origins.push_back(found.origin);
  }
  values.read = [reader, entity, runs](size_t run, size_t index) -> Result<idf::Data> {
    const Found& found = (*runs)[run][index];
    ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot, reader->read_recorded(entity, found.entry));
    return std::move(snapshot.instances[found.instance].data);
  };
  return values;
}

}  // namespace engram::training
