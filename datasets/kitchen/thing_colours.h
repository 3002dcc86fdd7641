// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the colours of things, where a recording gives them some.

#include <array>
#include <span>
#include <string_view>

#include "datasets/kitchen/kitchen_layout.h"

namespace engram::datasets::kitchen {

/// A colour that people have a word for.
struct NamedColour {
  std::string_view name;
  std::array<int, 3> rgb;
};

/// Returns all of them. They are so far apart that they can be told from each other in any light
/// of the kitchen.
[[nodiscard]] std::span<const NamedColour> thing_colours();

/// Gives each thing one of the colours by the seed of the layout, from a stream of random numbers
/// of its own, so that nothing else of a recording changes. A thing whose name says its colour
/// keeps it.
void give_colours(Layout& layout);

/// Returns the kind of a thing as it is drawn: in the thing's colour if it has one. What is printed
/// on it is then white, grey or black by its kind, so that kinds still look different.
[[nodiscard]] ThingClass drawn_class(const Thing& thing);

}  // namespace engram::datasets::kitchen
