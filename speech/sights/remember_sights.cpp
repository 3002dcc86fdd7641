// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "ltm/idf/type.h"
#include "speech/facts/known_facts.h"
#include "speech/sights/notice_sights.h"

namespace engram::speech {

namespace {

/// The middle of a thing is about so far above what it stands on.
constexpr double kAbove_m = 0.1;
/// A day has a million sightings. So many are committed together.
constexpr size_t kMaxCommitted = 4096;

idf::Data numbers_as_data(std::vector<double> values) {
  const auto count = static_cast<int64_t>(values.size());
  return idf::Data(idf::NdArray::take({count}, std::move(values)));
}

/// The pose of what stands somewhere on a place.
idf::Data pose_on(const KnownPlace& place) {
  if (!place.spot) return {};
  const Spot& spot = *place.spot;
  return idf::Data(idf::Dict{
      {std::string(idf::kPositionKey), numbers_as_data({spot.x, spot.y, spot.z + kAbove_m})},
      {std::string(idf::kOrientationKey),
       numbers_as_data({std::cos(spot.heading / 2), 0, 0, std::sin(spot.heading / 2)})}});
}

Result<ltm::MemoryId> thing_of(const ltm::MemoryId& kind) {
  return ltm::MemoryId::from_names(
      {"Objects", "Sightings", kSightsProvider, kind.names().back() + "_1"});
}

/// The times of which something was committed before.
Result<std::set<std::pair<ltm::MemoryId, Time>>> committed_before(Memory& memory) {
  std::set<std::pair<ltm::MemoryId, Time>> known;
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::Query all,
      ltm::Query::parse(std::string("?ids Objects/Sightings/") + kSightsProvider + " @ all"));
  const auto found = memory.query(all);
  if (!found.ok() && found.status().code() == StatusCode::kNotFound) return known;
  ENGRAM_RETURN_IF_ERROR(found.status());
  for (const ltm::EntityResult* entity : found->entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      known.emplace(entity->id, snapshot.time);
  return known;
}

idf::Dict value_of(const Sighting& sighting, const KnownWorld& world) {
  const auto place = ltm::MemoryId::parse(sighting.where);
  const KnownPlace* known =
      place.ok() && place->has_entity() ? world.place(place->entity()) : nullptr;
  const bool is_held =
      !sighting.where.empty() && known == nullptr && sighting.where.find('/') == std::string::npos;
  return {{"object_class", idf::Data(sighting.kind.to_string())},
          {"pose_world_object", known == nullptr ? idf::Data() : pose_on(*known)},
          {"is_visible", idf::Data(sighting.is_in_sight)},
          {"held_by", idf::Data(is_held ? sighting.where : std::string())},
          {"place", idf::Data(known == nullptr ? std::string() : known->entity.to_string())},
          {"colour", idf::Data(sighting.colour)},
          {"probability", idf::Data(sighting.probability)},
          {"read_from", idf::Data(idf::List{idf::Data(sighting.image.to_string())})}};
}

}  // namespace

Result<size_t> remember_sights(Memory& memory, const std::vector<Sighting>& sightings) {
  ENGRAM_ASSIGN_OR_RETURN(const auto facts, KnownFacts::read(memory));
  ENGRAM_ASSIGN_OR_RETURN(auto known, committed_before(memory));
  ltm::Commit commit;
  size_t count = 0;
  const auto flush = [&]() -> Status {
    if (commit.updates.empty()) return {};
    count += commit.updates.size();
    return memory.commit(std::exchange(commit, {}));
  };
  for (const Sighting& sighting : sightings) {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId thing, thing_of(sighting.kind));
    if (!known.emplace(thing, sighting.time).second) continue;
    commit.updates.push_back(
        {thing, sighting.time, {{idf::Data(value_of(sighting, facts->world())), {}}}});
    ltm::InstanceMetadata& metadata = commit.updates.back().instances.front().metadata;
    metadata.created = sighting.time;
    metadata.provider = kSightsProvider;
    metadata.confidence = static_cast<float>(sighting.probability);
    if (commit.updates.size() == kMaxCommitted) ENGRAM_RETURN_IF_ERROR(flush());
  }
  ENGRAM_RETURN_IF_ERROR(flush());
  return count;
}

}  // namespace engram::speech
