// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the initial state, which differs between recordings.

#include <cstdint>
#include <vector>

#include "datasets/kitchen/things.h"

namespace engram::datasets::kitchen {

struct NamedColour;

/// One object of a recording.
struct Thing {
  const ThingClass* type = nullptr;  ///< An element of all_thing_classes().
  Surface surface = Surface::kCounter;
  int slot = 0;
  double forward_m = 0;  ///< Offset from the middle of the slot, away from a person in front of it.
  double turn_rad = 0;   ///< Rotation to the left from the direction away from that person.
  /// An element of thing_colours(); null: it looks as its kind does, and no colour is recorded.
  const NamedColour* colour = nullptr;
};

struct Lighting {
  double lamp = 0.6;      ///< 0.5 to 0.68.
  double daylight = 0.3;  ///< 0.2 (dull) to 0.45.
  double warmth = 0.5;    ///< From 0, white, to 1, warm.
  double lamp_x_m = 0;    ///< Frame: world.
  double lamp_y_m = 0;
};

/// The objects in their initial places, the light, and the colours of the furniture.
struct Layout {
  uint64_t seed = 1;
  std::vector<Thing> things;  ///< 7 to 9 of them.
  Lighting light;
  double wood_tone = 0;   ///< From -1, dark, to 1, light.
  int cupboard_tone = 0;  ///< 0 to 2.
  /// A chair and a person can come into the room. They are no part of a batch recording, whose
  /// bytes must stay as they are.
  bool has_movables = false;
};

[[nodiscard]] Layout make_layout(uint64_t seed);

}  // namespace engram::datasets::kitchen
