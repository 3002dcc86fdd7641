// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/things.h"

#include <cmath>
#include <numbers>

namespace engram::datasets::kitchen {

std::span<const ThingClass> all_thing_classes() {
  // Layouts choose by index, so another order would give every seed other objects. The values are
  // in the order of the members of ThingClass, whose units the names there give.
  static const std::array<ThingClass, 10> kClasses{{
      {"cereal_box",
       "cereal",
       Shape::kBox,
       {0.150, 0.060, 0.220},
       0.40,
       0.120,
       {226, 150, 38},
       {150, 32, 20},
       "CRUNCH"},
      {"milk_carton",
       "milk",
       Shape::kBox,
       {0.075, 0.070, 0.210},
       0.70,
       0.110,
       {238, 242, 246},
       {32, 92, 178},
       "MILK"},
      {"tea_box",
       "tea",
       Shape::kBox,
       {0.130, 0.065, 0.120},
       0.15,
       0.065,
       {46, 118, 66},
       {244, 226, 164},
       "TEA"},
      {"salt_box",
       "salt",
       Shape::kBox,
       {0.080, 0.055, 0.150},
       0.45,
       0.085,
       {64, 138, 206},
       {250, 250, 250},
       "SALT"},
      {"juice_bottle",
       "juice",
       Shape::kBottle,
       {0.072, 0.072, 0.250},
       0.60,
       0.100,
       {238, 122, 24},
       {255, 244, 200},
       "JUICE"},
      {"oil_bottle",
       "oil",
       Shape::kBottle,
       {0.064, 0.064, 0.270},
       0.55,
       0.110,
       {150, 150, 40},
       {250, 240, 190},
       "OLIO"},
      {"soap_bottle",
       "dish soap",
       Shape::kBottle,
       {0.066, 0.066, 0.220},
       0.45,
       0.090,
       {70, 180, 120},
       {245, 255, 245},
       "SOAP"},
      {"tomato_can",
       "tomatoes",
       Shape::kCan,
       {0.074, 0.074, 0.110},
       0.42,
       0.060,
       {196, 36, 30},
       {250, 232, 190},
       "TOMATO"},
      {"coffee_can",
       "coffee",
       Shape::kCan,
       {0.080, 0.080, 0.140},
       0.50,
       0.080,
       {92, 54, 32},
       {240, 214, 160},
       "COFFEE"},
      {"blue_mug",
       "blue mug",
       Shape::kMug,
       {0.078, 0.078, 0.098},
       0.30,
       0.055,
       {40, 76, 156},
       {236, 238, 244},
       ""},
  }};
  return kClasses;
}

std::span<const ThingClass> movable_classes() {
  // A person is a column, so that it needs no heading to be in the way.
  static const std::array<ThingClass, 2> kClasses{{
      {"chair", "chair", Shape::kBox, {0.44, 0.44, 0.90}, 5.0, 0, {150, 104, 62}, {60, 40, 24}, ""},
      {"person",
       "person",
       Shape::kCan,
       {0.46, 0.46, 1.74},
       70.0,
       0,
       {58, 74, 120},
       {222, 184, 156},
       ""},
  }};
  return kClasses;
}

const ThingClass* class_named(std::string_view name) {
  for (const std::span<const ThingClass> all : {all_thing_classes(), movable_classes()})
    for (const ThingClass& type : all)
      if (type.name == name) return &type;
  return nullptr;
}

// The rows must stay free of the room's furniture (room_model.cpp). The counter's is shifted so
// that it lies between the sink and the stove, and the table's lies before the cloth.
const SurfacePlace& place_of(Surface surface) {
  static const SurfacePlace kCounter{
      "counter", "the counter", {0.0, 1.58, 0.90}, std::numbers::pi / 2, 0.64, 4.4, 0.17, -0.15};
  static const SurfacePlace kTable{
      "table", "the table", {-1.55, 0.10, 0.78}, std::numbers::pi, 0.75, 1.50, 0.20, 0.0};
  return surface == Surface::kCounter ? kCounter : kTable;
}

Eigen::Vector3d ahead(const SurfacePlace& place) {
  return {std::cos(place.heading_rad), std::sin(place.heading_rad), 0};
}

Eigen::Vector3d leftward(const SurfacePlace& place) {
  return {-std::sin(place.heading_rad), std::cos(place.heading_rad), 0};
}

std::optional<Surface> surface_below(const Eigen::Vector3d& point) {
  constexpr double kBesideSurface_m = 0.1;
  for (const Surface surface : {Surface::kCounter, Surface::kTable}) {
    const SurfacePlace& place = place_of(surface);
    const Eigen::Vector3d from = point - place.top_m;
    if (std::abs(from.dot(ahead(place))) < 0.5 * place.depth_m + kBesideSurface_m &&
        std::abs(from.dot(leftward(place))) < 0.5 * place.width_m + kBesideSurface_m &&
        from.z() > 0)
      return surface;
  }
  return std::nullopt;
}

Eigen::Vector3d slot_point(Surface surface, int slot) {
  const SurfacePlace& place = place_of(surface);
  // Slots count from the left, and the middle of the row is between the two middle ones.
  const double left = place.row_shift_m + (0.5 * (kSlots - 1) - slot) * kSlotDistance_m;
  return place.top_m + (place.row_m - 0.5 * place.depth_m) * ahead(place) + left * leftward(place);
}

}  // namespace engram::datasets::kitchen
