// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_layout.h"

#include <numeric>

#include "datasets/kitchen/kitchen_random.h"

namespace engram::datasets::kitchen {

namespace {

constexpr size_t kFewestThings = 7;
constexpr size_t kMaxThings = 9;
constexpr int kMaxOnASurface = kSlots - 1;  // At least one slot stays free to place things.
constexpr double kForward_m = 0.03;
constexpr double kTurn_rad = 0.30;

}  // namespace

Layout make_layout(uint64_t seed) {
  Random random(seed);
  Layout layout{.seed = seed};
  const std::span<const ThingClass> classes = all_thing_classes();
  std::vector<size_t> order(classes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  random.shuffle(order);
  const size_t count = kFewestThings + random.below(kMaxThings - kFewestThings + 1);

  // Slots of both surfaces in random order; a slot that would fill its surface is skipped.
  std::vector<int> places(2 * kSlots);
  std::iota(places.begin(), places.end(), 0);
  random.shuffle(places);
  std::array<int, 2> standing{};
  for (const int at : places) {
    const auto surface = static_cast<size_t>(at / kSlots);
    if (layout.things.size() == count || standing[surface] == kMaxOnASurface) continue;
    ++standing[surface];
    layout.things.push_back({.type = &classes[order[layout.things.size()]],
                             .surface = static_cast<Surface>(surface),
                             .slot = at % kSlots,
                             .forward_m = random.between(-kForward_m, kForward_m),
                             .turn_rad = random.between(-kTurn_rad, kTurn_rad)});
  }
  layout.light = {.lamp = random.between(0.50, 0.68),
                  .daylight = random.between(0.2, 0.45),
                  .warmth = random.between(0, 1),
                  .lamp_x_m = random.between(-0.9, 0.3),
                  .lamp_y_m = random.between(0.2, 0.8)};
  layout.wood_tone = random.between(-1, 1);
  layout.cupboard_tone = static_cast<int>(random.below(3));
  return layout;
}

}  // namespace engram::datasets::kitchen
