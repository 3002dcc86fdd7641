// SPDX-License-Identifier: Apache-2.0
#include "speech/facts/known_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ltm/core/ascii.h"

namespace engram::speech {

namespace {

/// How far beside an edge, and how far below a top, a thing that stands there may seem to be.
constexpr double kStandMargin_m = 0.05;
/// The middle of what stands on a top is at most so far above it.
constexpr double kMaxAbove_m = 0.6;

bool is_called(const std::vector<std::string>& names, const std::string& lower) {
  return std::find(names.begin(), names.end(), lower) != names.end();
}

/// How far a spot is from the outline of a place, along the floor; 0 inside.
double distance_to(const KnownPlace& place, const Spot& spot) {
  const double dx = spot.x - place.spot->x;
  const double dy = spot.y - place.spot->y;
  const double c = std::cos(place.spot->heading);
  const double s = std::sin(place.spot->heading);
  const double along = std::max(0.0, std::abs(c * dx + s * dy) - place.depth_m / 2);
  const double across = std::max(0.0, std::abs(c * dy - s * dx) - place.width_m / 2);
  return std::hypot(along, across);
}

}  // namespace

void KnownWorld::add_place(KnownPlace place) {
  for (KnownPlace& known : places_)
    if (known.entity == place.entity) {
      known = std::move(place);
      return;
    }
  places_.push_back(std::move(place));
}

const KnownThing* KnownWorld::thing(const ltm::MemoryId& entity) const {
  for (const KnownThing& known : things_)
    if (known.entity == entity) return &known;
  return nullptr;
}

const KnownPlace* KnownWorld::place(const ltm::MemoryId& entity) const {
  for (const KnownPlace& known : places_)
    if (known.entity == entity) return &known;
  return nullptr;
}

std::vector<ltm::MemoryId> KnownWorld::things_called(const std::string& name) const {
  const std::string lower = lower_ascii(name);
  std::vector<ltm::MemoryId> found;
  for (const KnownThing& known : things_)
    if (known.entity && is_called(known.names, lower)) found.push_back(*known.entity);
  return found;
}

std::vector<ltm::MemoryId> KnownWorld::places_called(const std::string& name) const {
  const std::string lower = lower_ascii(name);
  std::vector<ltm::MemoryId> found;
  for (const KnownPlace& known : places_)
    if (is_called(known.names, lower)) found.push_back(known.entity);
  return found;
}

bool KnownWorld::knows_thing(const std::string& name) const {
  const std::string lower = lower_ascii(name);
  return std::any_of(things_.begin(), things_.end(),
                     [&](const KnownThing& known) { return is_called(known.names, lower); });
}

std::string KnownWorld::spoken(const ltm::MemoryId& entity) const {
  if (const KnownThing* known = thing(entity)) return known->spoken;
  if (const KnownPlace* known = place(entity)) return known->spoken;
  return entity.names().empty() ? std::string() : words_of_name(entity.names().back());
}

const KnownPlace* KnownWorld::under(const Spot& spot) const {
  const KnownPlace* found = nullptr;
  for (const KnownPlace& place : places_) {
    if (!place.spot || place.depth_m <= 0 || distance_to(place, spot) > kStandMargin_m) continue;
    const double above = spot.z - place.spot->z;
    if (above < -kStandMargin_m || above > kMaxAbove_m) continue;
    if (found == nullptr || place.spot->z > found->spot->z) found = &place;
  }
  return found;
}

const KnownPlace* KnownWorld::beside(const Spot& spot, double max_m) const {
  const KnownPlace* found = nullptr;
  double nearest = max_m;
  for (const KnownPlace& place : places_) {
    if (!place.spot) continue;
    const double distance = distance_to(place, spot);
    if (distance > nearest) continue;
    nearest = distance;
    found = &place;
  }
  return found;
}

std::string words_of_name(const std::string& name) {
  std::string words = lower_ascii(name);
  // "cup_2" is the second cup, and people say "cup".
  const size_t last = words.find_last_not_of("0123456789");
  if (last != std::string::npos && last > 0 && last + 1 < words.size() && words[last] == '_')
    words.resize(last);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string words_of_hand(const std::string& name) {
  constexpr std::string_view kHand = " hand";
  std::string words = words_of_name(name);
  if (words.size() > kHand.size() && words.ends_with(kHand))
    words.resize(words.size() - kHand.size());
  return words;
}

bool says_hand(const std::string& words) {
  constexpr std::array<std::string_view, 3> kKinds{"hand", "gripper", "arm"};
  return std::any_of(kKinds.begin(), kKinds.end(), [&](std::string_view kind) {
    return words == kind || words.ends_with(" " + std::string(kind));
  });
}

std::string spoken_hand(const std::string& name) {
  std::string words = words_of_hand(name);
  return says_hand(words) ? words : words + " hand";
}

}  // namespace engram::speech
