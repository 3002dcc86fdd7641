// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>

#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/textures.h"

namespace engram::datasets::kitchen {

namespace {

// Pictures lie in the x-y plane of a geom, so upright geoms with pictures are rotated.
constexpr const char* kFacesRobot = R"(xyaxes="1 0 0 0 0 1")";
constexpr const char* kFacesRight = R"(xyaxes="0 1 0 0 0 1")";
constexpr const char* kFacesLeft = R"(xyaxes="0 -1 0 0 0 1")";
constexpr const char* kFacesBack = R"(xyaxes="-1 0 0 0 0 1")";

constexpr double kWall_y = 1.91;
constexpr double kCounterFront_y = 1.28;

/// Adds a box with half sizes that is seen; `look` is a material or colour, and further attributes.
void add_box(ModelText& text, double x, double y, double z, double half_x, double half_y,
             double half_z, std::string_view look, std::string_view turn = "") {
  if (!text.is_painted) return;
  text.bodies += fmt::format(
      R"(<geom type="box" pos="{:.4f} {:.4f} {:.4f}" size="{:.4f} {:.4f} {:.4f}" {} {}/>
)",
      x, y, z, half_x, half_y, half_z, look, turn);
}

/// Adds the top of a piece of furniture, which is not seen but touched.
void add_top(ModelText& text, std::string_view name, const Eigen::Vector3d& middle,
             const Eigen::Vector3d& half) {
  text.bodies += fmt::format(
      R"(<geom {} type="box" pos="{:.4f} {:.4f} {:.4f}" size="{:.4f} {:.4f} {:.4f}"/>
)",
      text.solid(name, false), middle.x(), middle.y(), middle.z(), half.x(), half.y(), half.z());
}

void add_capsule(ModelText& text, const std::array<double, 6>& from_to, double radius,
                 std::string_view look) {
  if (!text.is_painted) return;
  text.bodies += fmt::format(
      R"(<geom type="capsule" fromto="{} {} {} {} {} {}" size="{}" {}/>
)",
      from_to[0], from_to[1], from_to[2], from_to[3], from_to[4], from_to[5], radius, look);
}

void add_materials(const Layout& layout, ModelText& text) {
  const uint64_t seed = layout.seed;
  static const std::array<cv::Scalar, 3> kDoors{
      cv::Scalar(226, 220, 206), cv::Scalar(126, 152, 150), cv::Scalar(176, 132, 88)};
  const cv::Scalar door = kDoors.at(static_cast<size_t>(layout.cupboard_tone));
  text.add_material(
      "floor", [&] { return paint_floor_tiles(512, seed); }, false, 2.4, 2.0,
      R"(specular="0.15" shininess="0.3")");
  text.add_material(
      "tiles", [&] { return paint_wall_tiles(512, seed + 1); }, false, 6, 1,
      R"(specular="0.4" shininess="0.6")");
  text.add_material(
      "plaster", [&] { return paint_plaster(256, cv::Scalar(208, 194, 168), seed + 2); }, false, 4,
      3, R"(specular="0" shininess="0")");
  text.add_material(
      "table_wood", [&] { return paint_wood(512, 6, layout.wood_tone, seed + 3); }, false, 1, 1,
      R"(specular="0.25" shininess="0.4")");
  text.add_material(
      "leg_wood", [&] { return paint_wood(128, 1, layout.wood_tone - 0.4, seed + 4); }, false, 1, 1,
      R"(specular="0.1")");
  text.add_material(
      "stone", [&] { return paint_stone(512, seed + 5); }, false, 6, 1,
      R"(specular="0.35" shininess="0.6")");
  text.add_material(
      "door", [&] { return paint_door(256, door, seed + 6); }, false, 1, 1, R"(specular="0.2")");
  text.add_material(
      "garden", [&] { return paint_garden(512, seed + 7); }, false, 1, 1,
      R"(emission="0.38" specular="0")");
  text.add_material(
      "stove", [&] { return paint_stove(256); }, false, 1, 1, R"(specular="0.7" shininess="0.9")");
  text.add_material(
      "cloth", [&] { return paint_cloth(256, seed + 8); }, false, 2, 4, R"(specular="0")");
  text.add_material(
      "steel", [&] { return paint_brushed_steel(256, seed + 9); }, false, 1, 1,
      R"(specular="0.6" shininess="0.7")");
  text.assets +=
      R"(<material name="dark_steel" rgba="0.32 0.33 0.35 1" specular="0.6" shininess="0.7"/>
<material name="frame" rgba="0.80 0.79 0.75 1" specular="0.2"/>
<material name="oven" rgba="0.09 0.09 0.1 1" specular="0.8" shininess="0.8"/>
<material name="kick" rgba="0.16 0.15 0.15 1" specular="0"/>
)";
}

void add_walls(ModelText& text) {
  if (!text.is_painted) return;
  text.bodies += R"(<geom type="plane" size="3.4 2.8 0.1" material="floor"/>
)";
  text.bodies += R"(<geom type="box" pos="0 -0.3 2.63" size="3.2 2.4 0.03" rgba="0.84 0.82 0.78 1"/>
)";
  constexpr const char* kPlaster = R"(material="plaster")";
  add_box(text, 0, kWall_y + 0.05, 1.3, 3.2, 1.3, 0.05, kPlaster, kFacesRobot);
  add_box(text, -2.95, -0.3, 1.3, 2.3, 1.3, 0.05, kPlaster, kFacesRight);
  add_box(text, 2.65, -0.3, 1.3, 2.3, 1.3, 0.05, kPlaster, kFacesLeft);
  add_box(text, 0, -2.45, 1.3, 3.2, 1.3, 0.05, kPlaster, kFacesBack);
  add_box(text, -0.15, kWall_y - 0.005, 1.17, 2.45, 0.27, 0.004, R"(material="tiles")",
          kFacesRobot);
}

void add_window(ModelText& text) {
  constexpr double kX = -0.15;
  constexpr double kZ = 1.66;
  constexpr double kHalfWidth = 0.56;
  constexpr double kHalfHeight = 0.44;
  constexpr const char* kFrame = R"(material="frame")";
  add_box(text, kX, kWall_y - 0.012, kZ, kHalfWidth, kHalfHeight, 0.004, R"(material="garden")",
          kFacesRobot);
  for (const double x : {-kHalfWidth, 0.0, kHalfWidth})
    add_box(text, kX + x, kWall_y - 0.03, kZ, x == 0 ? 0.018 : 0.03, 0.03, kHalfHeight, kFrame);
  for (const double z : {-kHalfHeight, 0.15, kHalfHeight})
    add_box(text, kX, kWall_y - 0.03, kZ + z, kHalfWidth, 0.03, z == 0.15 ? 0.015 : 0.03, kFrame);
  add_box(text, kX, kWall_y - 0.08, kZ - kHalfHeight - 0.03, kHalfWidth + 0.05, 0.08, 0.015,
          kFrame);
}

/// Adds doors with handles, each 0.6 m wide.
void add_lower_cupboards(ModelText& text) {
  constexpr double kHalf = 0.295;
  constexpr const char* kHandle = R"(material="dark_steel")";
  for (int i = 0; i < 7; ++i) {
    const double x = -2.1 + 0.6 * i;
    const bool is_oven = i == 5;
    add_box(text, x, 1.60, 0.47, 0.30, 0.30, 0.385, R"(material="frame")");
    if (is_oven) {
      add_box(text, x, kCounterFront_y, 0.40, kHalf, 0.29, 0.012, R"(material="oven")",
              kFacesRobot);
      add_box(text, x, kCounterFront_y, 0.78, kHalf, 0.075, 0.014, R"(material="steel")",
              kFacesRobot);
      add_capsule(text, {x - 0.22, 1.24, 0.66, x + 0.22, 1.24, 0.66}, 0.011, kHandle);
      for (const double knob : {-0.2, -0.1, 0.1, 0.2})
        add_capsule(text, {x + knob, 1.265, 0.79, x + knob, 1.245, 0.79}, 0.02, kHandle);
      continue;
    }
    add_box(text, x, kCounterFront_y, 0.385, kHalf, 0.285, 0.012, R"(material="door")",
            kFacesRobot);
    add_box(text, x, kCounterFront_y, 0.765, kHalf, 0.085, 0.012, R"(material="door")",
            kFacesRobot);
    add_capsule(text, {x - 0.07, 1.245, 0.79, x + 0.07, 1.245, 0.79}, 0.007, kHandle);
    add_capsule(text, {x + 0.2, 1.245, 0.50, x + 0.2, 1.245, 0.62}, 0.007, kHandle);
  }
  add_box(text, 0, 1.66, 0.05, 2.4, 0.30, 0.05, R"(material="kick")");
}

void add_counter(ModelText& text) {
  const SurfacePlace& counter = place_of(Surface::kCounter);
  const double half_depth = 0.5 * counter.depth_m;
  add_lower_cupboards(text);
  add_box(text, 0, counter.top_m.y(), counter.top_m.z() - 0.02, 0.5 * counter.width_m, half_depth,
          0.02, R"(material="stone")");
  add_top(text, "counter", {0, counter.top_m.y(), counter.top_m.z() - 0.05},
          {0.5 * counter.width_m, half_depth, 0.05});
  // The stove, and the hood above it.
  add_box(text, 0.98, 1.57, 0.903, 0.23, 0.25, 0.004, R"(material="stove")");
  add_box(text, 0.98, 1.70, 1.66, 0.30, 0.21, 0.05, R"(material="steel")");
  add_box(text, 0.98, 1.79, 2.1, 0.13, 0.12, 0.42, R"(material="steel")");
  // The sink with its tap.
  add_box(text, -1.25, 1.55, 0.901, 0.27, 0.21, 0.004, R"(material="steel")");
  add_box(text, -1.25, 1.55, 0.9035, 0.23, 0.17, 0.003, R"(material="dark_steel")");
  add_capsule(text, {-1.25, 1.80, 0.9, -1.25, 1.80, 1.16}, 0.014, R"(material="steel")");
  add_capsule(text, {-1.25, 1.80, 1.16, -1.25, 1.66, 1.20}, 0.012, R"(material="steel")");
  add_capsule(text, {-1.25, 1.66, 1.20, -1.25, 1.62, 1.15}, 0.012, R"(material="steel")");
}

void add_upper_cupboards(ModelText& text) {
  for (const double x : {-2.05, -1.55, -1.05, 0.56, 1.42}) {
    const double half = x == 1.42 ? 0.13 : x == 0.56 ? 0.11 : 0.245;
    add_box(text, x, 1.74, 1.80, half, 0.17, 0.36, R"(material="frame")");
    add_box(text, x, 1.56, 1.80, half - 0.005, 0.355, 0.012, R"(material="door")", kFacesRobot);
    add_capsule(text, {x + half - 0.06, 1.53, 1.50, x + half - 0.06, 1.53, 1.60}, 0.007,
                R"(material="dark_steel")");
  }
  // The fridge.
  add_box(text, 1.95, 1.57, 0.95, 0.31, 0.32, 0.93, R"(material="frame" rgba="0.78 0.79 0.81 1")");
  add_box(text, 1.95, 1.24, 1.30, 0.30, 0.57, 0.012, R"(material="steel")", kFacesRobot);
  add_box(text, 1.95, 1.24, 0.37, 0.30, 0.34, 0.012, R"(material="steel")", kFacesRobot);
  add_capsule(text, {1.70, 1.20, 0.85, 1.70, 1.20, 1.25}, 0.012, R"(material="dark_steel")");
}

/// Adds a bowl of fruit.
void add_bowl(ModelText& text, double x, double y, double z) {
  if (!text.is_painted) return;
  text.bodies += fmt::format(
      R"(<geom type="ellipsoid" pos="{0} {1} {2}" size="0.13 0.13 0.035" rgba="0.9 0.88 0.82 1"/>
<geom type="sphere" pos="{3} {1} {4}" size="0.038" rgba="0.72 0.16 0.12 1"/>
<geom type="sphere" pos="{0} {5} {4}" size="0.040" rgba="0.90 0.55 0.12 1"/>
<geom type="sphere" pos="{6} {1} {4}" size="0.037" rgba="0.50 0.66 0.20 1"/>
)",
      x - 0.15, y, z + 0.03, x - 0.195, z + 0.07, y + 0.06, x - 0.105);
}

void add_table(ModelText& text) {
  const SurfacePlace& table = place_of(Surface::kTable);
  const double x = table.top_m.x();
  const double y = table.top_m.y();
  const double z = table.top_m.z();
  const double half_depth = 0.5 * table.depth_m;
  const double half_width = 0.5 * table.width_m;
  add_box(text, x, y, z - 0.018, half_width, half_depth, 0.018, R"(material="table_wood")",
          R"(xyaxes="0 1 0 -1 0 0")");
  add_top(text, "table", {x, y, z - 0.05}, {half_depth, half_width, 0.05});
  for (const double side : {-1.0, 1.0})
    for (const double end : {-1.0, 1.0})
      add_box(text, x + side * (half_depth - 0.06), y + end * (half_width - 0.06), 0.37, 0.03, 0.03,
              0.37, R"(material="leg_wood")");
  // A cloth with a bowl of fruit, outside the robot's reach.
  add_box(text, x - 0.14, y, z + 0.0008, 0.17, 0.5, 0.0008, R"(material="cloth")");
  add_bowl(text, x, y, z);
  for (const double along : {-0.38, 0.38}) {
    const double seat_x = x - 0.62;
    add_box(text, seat_x, y + along, 0.45, 0.20, 0.20, 0.015, R"(material="leg_wood")");
    add_box(text, seat_x - 0.19, y + along, 0.80, 0.19, 0.13, 0.012, R"(material="leg_wood")",
            kFacesRight);
    for (const double leg_x : {-0.18, 0.18})
      for (const double leg_y : {-0.18, 0.18})
        add_box(text, seat_x + leg_x, y + along + leg_y, leg_x < 0 ? 0.46 : 0.22, 0.015, 0.015,
                leg_x < 0 ? 0.46 : 0.22, R"(material="leg_wood")");
  }
  // A picture on the wall behind it.
  add_box(text, -2.885, y, 1.55, 0.36, 0.27, 0.012, R"(material="kick")", kFacesRight);
  add_box(text, -2.875, y, 1.55, 0.33, 0.24, 0.012, R"(material="garden")", kFacesRight);
}

void add_lights(const Lighting& light, ModelText& text) {
  const double warm = light.warmth;
  text.bodies += fmt::format(
      R"(<light name="lamp" pos="{} {} 2.5" dir="0 0.12 -1" castshadow="true"
 cutoff="72" exponent="0.4" diffuse="{} {} {}" specular="0.35 0.33 0.3" ambient="0 0 0"/>
<light name="window" directional="true" castshadow="false" pos="0 3 2" dir="0.15 -0.7 -0.7"
 diffuse="{} {} {}" specular="0.2 0.2 0.2" ambient="0 0 0"/>
)",
      light.lamp_x_m, light.lamp_y_m, light.lamp, light.lamp * (1 - 0.08 * warm),
      light.lamp * (1 - 0.28 * warm), light.daylight * 0.92, light.daylight * 0.96, light.daylight);
}

}  // namespace

void add_room(const Layout& layout, ModelText& text) {
  add_materials(layout, text);
  add_lights(layout.light, text);
  add_walls(text);
  add_window(text);
  add_counter(text);
  add_upper_cupboards(text);
  add_table(text);
}

}  // namespace engram::datasets::kitchen
