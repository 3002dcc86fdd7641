// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"

namespace engram::speech {

/// Where something is along the floor and above it. Unit: m, rad. Frame: world.
struct Spot {
  double x = 0;
  double y = 0;
  double z = 0;
  double heading = 0;  ///< Of its x axis, from the x axis of the world to its y axis.
};

/// A thing that the memory knows, or a kind of thing of which it has seen none.
struct KnownThing {
  std::optional<ltm::MemoryId> entity;  ///< Nothing: only the kind is known.
  std::string spoken;                   ///< As people call it: "red cup".
  std::vector<std::string> names;       ///< All that it may be called, in lower case; `spoken` too.
  ltm::MemoryId evidence;               ///< The instance that the names are from.
};

/// A piece of furniture that things stand on, or a place that has a name.
struct KnownPlace {
  ltm::MemoryId entity;
  ltm::MemoryId evidence;  ///< The instance that tells of it.
  std::string spoken;
  std::vector<std::string> names;
  std::optional<Spot> spot;  ///< Nothing: it does not say where it is.
  double depth_m = 0;        ///< Along the x axis of its spot; 0: it is a point.
  double width_m = 0;
};

/// How a thing was at one time.
struct ThingState {
  ltm::MemoryId id;
  Time time{};
  std::optional<Spot> spot;
  std::optional<bool> is_visible;
  std::string held_by;   ///< The words of the hand; empty: nothing holds it.
  std::string colour{};  ///< Its word: "red"; empty: it is not told.
  /// What it was read from: the images of a thing that was seen in them (speech/sights).
  std::vector<ltm::MemoryId> read_from{};
};

/// Which things and places there are, what they are called, and what is where.
///
/// Threading: const-parallel.
class KnownWorld {
 public:
  [[nodiscard]] const std::vector<KnownThing>& things() const { return things_; }
  [[nodiscard]] const std::vector<KnownPlace>& places() const { return places_; }

  void add_thing(KnownThing thing) { things_.push_back(std::move(thing)); }
  /// A newer snapshot of a place replaces the older one.
  void add_place(KnownPlace place);

  [[nodiscard]] const KnownThing* thing(const ltm::MemoryId& entity) const;
  [[nodiscard]] const KnownPlace* place(const ltm::MemoryId& entity) const;

  /// The entities of all things that are called so; case does not count.
  [[nodiscard]] std::vector<ltm::MemoryId> things_called(const std::string& name) const;
  [[nodiscard]] std::vector<ltm::MemoryId> places_called(const std::string& name) const;
  /// Whether a thing is called so, also where only its kind is known.
  [[nodiscard]] bool knows_thing(const std::string& name) const;

  /// What an entity is called; of an unknown one the words of its last name.
  [[nodiscard]] std::string spoken(const ltm::MemoryId& entity) const;

  /// The place that something at this spot stands on: the highest one below it.
  [[nodiscard]] const KnownPlace* under(const Spot& spot) const;
  /// The place whose edge is nearest along the floor, at most `max_m` away.
  [[nodiscard]] const KnownPlace* beside(const Spot& spot, double max_m) const;

 private:
  std::vector<KnownThing> things_;
  std::vector<KnownPlace> places_;
};

/// "salt_box_1" as words: "salt box".
[[nodiscard]] std::string words_of_name(const std::string& name);

/// "Right_Hand", "right hand" and "right" as a word: "right".
[[nodiscard]] std::string words_of_hand(const std::string& name);

/// Whether these words say by themselves what they are: "gripper", "left arm".
[[nodiscard]] bool says_hand(const std::string& words);
/// A hand as people call it: "right hand", "gripper".
[[nodiscard]] std::string spoken_hand(const std::string& name);

}  // namespace engram::speech
