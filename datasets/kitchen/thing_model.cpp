// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/textures.h"
#include "datasets/kitchen/thing_colours.h"

namespace engram::datasets::kitchen {

namespace {

constexpr int kFacePixels = 128;

/// The visible geoms of a thing. Frame: the thing's, whose origin is its middle.
std::string geoms_of(const ThingClass& type) {
  const double radius = 0.5 * type.size_m.x();
  const double half = 0.5 * type.size_m.z();
  switch (type.shape) {
    case Shape::kBox:
      return fmt::format(R"(<geom type="box" size="{} {} {}" material="{}"/>)", radius,
                         0.5 * type.size_m.y(), half, type.name);
    case Shape::kCan:
      return fmt::format(R"(<geom type="cylinder" size="{} {}" material="{}"/>)", radius, half,
                         type.name);
    case Shape::kBottle: {
      const double body = 0.68 * half;  // The rest is shoulder, neck and cap.
      return fmt::format(
          R"(<geom type="cylinder" size="{0} {1}" pos="0 0 {2}" material="{3}"/>
<geom type="ellipsoid" size="{0} {0} {4}" pos="0 0 {5}" material="{3}_plain"/>
<geom type="cylinder" size="{6} {7}" pos="0 0 {8}" material="{3}_plain"/>
<geom type="cylinder" size="{9} 0.011" pos="0 0 {10}" rgba="0.93 0.93 0.9 1"/>)",
          radius, body, body - half, type.name, 0.30 * half, 2 * body - half, 0.38 * radius,
          0.18 * half, 0.76 * half, 0.46 * radius, half - 0.011);
    }
    case Shape::kMug:
      return fmt::format(
          R"(<geom type="cylinder" size="{0} {1}" material="{2}"/>
<geom type="cylinder" size="{3} 0.0015" pos="0 0 {1}" rgba="0.16 0.10 0.07 1"/>
<geom type="capsule" fromto="{0} 0 {4} {5} 0 {6}" size="0.006" material="{2}_plain"/>
<geom type="capsule" fromto="{5} 0 {6} {5} 0 {7}" size="0.006" material="{2}_plain"/>
<geom type="capsule" fromto="{5} 0 {7} {0} 0 {8}" size="0.006" material="{2}_plain"/>)",
          radius, half, type.name, 0.88 * radius, 0.6 * half, radius + 0.026, 0.45 * half,
          -0.35 * half, -0.5 * half);
  }
  return {};
}

}  // namespace

void add_things(const Layout& layout, ModelText& text) {
  for (const Thing& thing : layout.things) {
    const ThingClass type = drawn_class(thing);
    text.add_material(
        std::string(type.name), [&] { return paint_thing(type, kFacePixels, layout.seed); }, true,
        1, 1, R"(specular="0.3" shininess="0.5")");
    text.assets += fmt::format(
        R"(<material name="{}_plain" rgba="{:.3f} {:.3f} {:.3f} 1" specular="0.4" shininess="0.6"/>
)",
        type.name, type.colour[0] / 255.0, type.colour[1] / 255.0, type.colour[2] / 255.0);
    // The collision shape is a box: edges of cylinders on large boxes make contacts that explode.
    const SurfacePlace& place = place_of(thing.surface);
    const Eigen::Vector3d foot =
        slot_point(thing.surface, thing.slot) + thing.forward_m * ahead(place);
    const double turn = place.heading_rad + thing.turn_rad;
    text.bodies += fmt::format(
        R"(<body name="{0}" pos="{1:.5f} {2:.5f} {3:.5f}" euler="0 0 {4:.5f}">
<freejoint name="{0}"/>
<geom {10} type="box" size="{5} {6} {7}" mass="{8}"
 friction="0.9 0.01 0.001" solref="0.008 1"/>
{9}
</body>
)",
        type.name, foot.x(), foot.y(), foot.z() + 0.5 * type.size_m.z() + 0.001, turn,
        0.5 * type.size_m.x() * (type.shape == Shape::kBox ? 1 : 0.9),
        0.5 * type.size_m.y() * (type.shape == Shape::kBox ? 1 : 0.9), 0.5 * type.size_m.z(),
        type.mass_kg, geoms_of(type), text.solid(type.name, true));
    for (const char* side : {"left", "right"})
      text.constraints += fmt::format(
          R"(<weld name="{0}:{1}" body1="{0}_hand" body2="{1}" active="false" solref="0.006 1"/>
)",
          side, type.name);
  }
}

}  // namespace engram::datasets::kitchen
