// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/thing_colours.h"

#include "datasets/kitchen/kitchen_random.h"

namespace engram::datasets::kitchen {

namespace {

/// Sets the stream of colours apart from those of layouts and scripts.
constexpr uint64_t kColourStream = 0xC0105;

constexpr std::array<int, 3> kWhite{244, 244, 240};
constexpr std::array<int, 3> kGrey{128, 128, 128};
constexpr std::array<int, 3> kBlack{24, 24, 28};

/// What is printed on a kind of thing, in the order of all_thing_classes(). Things of one shape and
/// about one size have different prints.
constexpr std::array<std::array<int, 3>, 10> kPrints{kBlack, kWhite, kWhite, kBlack, kWhite,
                                                     kBlack, kGrey,  kWhite, kBlack, kWhite};

const NamedColour* colour_in(std::string_view name) {
  for (const NamedColour& colour : thing_colours())
    if (name.starts_with(colour.name)) return &colour;
  return nullptr;
}

}  // namespace

std::span<const NamedColour> thing_colours() {
  static constexpr std::array<NamedColour, 6> kColours{{
      {"red", {206, 26, 30}},
      {"yellow", {244, 208, 24}},
      {"green", {36, 148, 52}},
      {"turquoise", {34, 196, 196}},
      {"blue", {34, 66, 196}},
      {"purple", {150, 44, 172}},
  }};
  return kColours;
}

void give_colours(Layout& layout) {
  const std::span<const NamedColour> colours = thing_colours();
  Random random(layout.seed ^ (kColourStream << 32));
  for (Thing& thing : layout.things) {
    // Every thing takes a number, so that the colours of the others do not depend on its name.
    const NamedColour& drawn = colours[random.below(colours.size())];
    const NamedColour* own = colour_in(thing.type->name);
    thing.colour = own != nullptr ? own : &drawn;
  }
}

ThingClass drawn_class(const Thing& thing) {
  ThingClass type = *thing.type;
  if (thing.colour == nullptr || colour_in(type.name) != nullptr) return type;
  type.colour = thing.colour->rgb;
  type.accent = kPrints.at(static_cast<size_t>(thing.type - all_thing_classes().data()));
  return type;
}

}  // namespace engram::datasets::kitchen
