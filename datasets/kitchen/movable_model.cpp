// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/movable_places.h"

namespace engram::datasets::kitchen {

namespace {

/// Frame: the middle of the chair; its back is at -x.
constexpr const char* kChairGeoms =
    R"(<geom type="box" pos="0 0 0.005" size="0.21 0.21 0.018" material="chair"/>
<geom type="box" pos="-0.20 0 0.235" size="0.014 0.20 0.215" material="chair"/>
<geom type="box" pos="0.18 0.18 -0.23" size="0.018 0.018 0.22" material="chair_leg"/>
<geom type="box" pos="0.18 -0.18 -0.23" size="0.018 0.018 0.22" material="chair_leg"/>
<geom type="box" pos="-0.18 0.18 -0.23" size="0.018 0.018 0.22" material="chair_leg"/>
<geom type="box" pos="-0.18 -0.18 -0.23" size="0.018 0.018 0.22" material="chair_leg"/>)";

/// Frame: the middle of the person, who looks along x. The feet are at -0.87 m.
constexpr const char* kPersonGeoms =
    R"(<geom type="capsule" fromto="0 0.09 -0.78 0 0.10 -0.08" size="0.085" material="trousers"/>
<geom type="capsule" fromto="0 -0.09 -0.78 0 -0.10 -0.08" size="0.085" material="trousers"/>
<geom type="box" pos="0.05 0.09 -0.84" size="0.12 0.045 0.03" material="chair_leg"/>
<geom type="box" pos="0.05 -0.09 -0.84" size="0.12 0.045 0.03" material="chair_leg"/>
<geom type="ellipsoid" pos="0 0 0.23" size="0.13 0.19 0.34" material="shirt"/>
<geom type="capsule" fromto="0 0.20 0.44 0.06 0.21 -0.06" size="0.05" material="shirt"/>
<geom type="capsule" fromto="0 -0.20 0.44 0.06 -0.21 -0.06" size="0.05" material="shirt"/>
<geom type="capsule" fromto="0 0 0.50 0 0 0.62" size="0.05" material="skin"/>
<geom type="ellipsoid" pos="0.01 0 0.745" size="0.10 0.085 0.125" material="skin"/>
<geom type="ellipsoid" pos="-0.025 0 0.775" size="0.095 0.092 0.11" material="hair"/>)";

}  // namespace

void add_movables(ModelText& text) {
  text.assets += R"(<material name="chair" rgba="0.59 0.41 0.24 1" specular="0.2" shininess="0.3"/>
<material name="chair_leg" rgba="0.24 0.16 0.09 1" specular="0.1"/>
<material name="trousers" rgba="0.16 0.17 0.20 1" specular="0"/>
<material name="shirt" rgba="0.23 0.29 0.47 1" specular="0"/>
<material name="skin" rgba="0.87 0.72 0.61 1" specular="0.1"/>
<material name="hair" rgba="0.20 0.13 0.08 1" specular="0.2"/>
)";
  for (size_t i = 0; i < movable_classes().size(); ++i) {
    const ThingClass& type = movable_classes()[i];
    const Eigen::Vector3d at = place_away(i).translation();
    const Eigen::Vector3d half = 0.5 * type.size_m;
    // Things collide with a box; it is drawn by parts that touch nothing.
    text.bodies += fmt::format(
        R"(<body name="{}" mocap="true" pos="{} {} {}">
<geom {} type="box" size="{} {} {}"/>
{}
</body>
)",
        type.name, at.x(), at.y(), at.z(), text.solid(type.name, false), half.x(), half.y(),
        half.z(), type.shape == Shape::kBox ? kChairGeoms : kPersonGeoms);
  }
}

}  // namespace engram::datasets::kitchen
