// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <numbers>

#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/robot_body.h"

namespace engram::datasets::kitchen {

namespace {

constexpr const char* kShell = R"(material="shell")";
constexpr const char* kJointLook = R"(material="joint")";

/// Two phalanges that bend towards the palm.
std::string finger(const std::string& side, const char* name, double z, double toward) {
  return fmt::format(
      R"(<body pos="0.098 0 {0}">
<joint name="{1}_{2}_1" axis="0 0 {3}" range="-0.1 1.6" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0.042 0 0" size="0.0105" {4}/>
<body pos="0.046 0 0">
<joint name="{1}_{2}_2" axis="0 0 {3}" range="-0.1 1.8" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0.034 0 0" size="0.0095" {5}/>
</body></body>
)",
      z, side, name, toward, kShell, kJointLook);
}

/// Rotates about the hand's x axis until it opposes the fingers, then bends.
std::string thumb(const std::string& side, double toward) {
  return fmt::format(
      R"(<body pos="0.030 {0} 0.040">
<joint name="{1}_thumb_1" axis="{2} 0 0" range="-0.2 1.5" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0 {3} 0" size="0.0105" {5}/>
<body pos="0 {4} 0">
<joint name="{1}_thumb_2" axis="0 0 {6}" range="-0.3 1.8" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0 {7} 0" size="0.0105" {8}/>
<body pos="0 {7} 0">
<joint name="{1}_thumb_3" axis="0 0 {6}" range="-0.3 1.2" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0 {7} 0" size="0.010" {8}/>
<body pos="0 {7} 0">
<joint name="{1}_thumb_4" axis="0 0 {6}" range="-0.3 1.2" armature="0.005"/>
<geom type="capsule" fromto="0 0 0 0 {9} 0" size="0.009" {5}/>
</body></body></body></body>
)",
      toward * 0.006, side, toward, toward * kThumbBase_m * 0.9, toward * kThumbBase_m, kJointLook,
      -toward, toward * 0.034, kShell, toward * 0.022);
}

std::string hand(const std::string& side, double toward) {
  std::string text = fmt::format(
      R"(<body name="{}_hand" pos="0 0 -0.04" xyaxes="0 0 -1 0 1 0">
<geom type="box" pos="0.052 0 0" size="0.046 0.014 0.041" {}/>
<geom type="box" pos="0.052 {} 0" size="0.040 0.003 0.036" {}/>
<geom type="cylinder" fromto="-0.02 0 0 0.01 0 0" size="0.028" {}/>
)",
      side, kShell, -toward * 0.014, R"(material="accent")", kJointLook);
  int i = 0;
  for (const char* name : {"index", "middle", "ring", "little"})
    text += finger(side, name, 0.032 - 0.0215 * i++, toward);
  return text + thumb(side, toward) + "</body>\n";
}

/// An arm that hangs down. Positive angles lift it forward or outward, and bend the elbow.
std::string arm(const std::string& side, double left) {
  return fmt::format(
      R"(<body pos="0 {0} 0.42">
<joint name="{1}_shoulder_pitch" axis="0 -1 0" range="-1.2 3.0" armature="0.3"/>
<joint name="{1}_shoulder_roll" axis="{3} 0 0" range="-0.4 2.6" armature="0.3"/>
<joint name="{1}_shoulder_yaw" axis="0 0 {3}" range="-1.8 1.8" armature="0.2"/>
<geom type="sphere" size="0.078" {2}/>
<geom type="capsule" fromto="0 0 -0.05 0 0 -0.26" size="0.056" {4}/>
<geom type="cylinder" fromto="0 0 -0.12 0 0 -0.15" size="0.0575" material="accent"/>
<body pos="0 0 -0.30">
<joint name="{1}_elbow" axis="0 -1 0" range="0.02 2.5" armature="0.2"/>
<joint name="{1}_forearm_roll" axis="0 0 {3}" range="-2.4 2.4" armature="0.1"/>
<geom type="sphere" size="0.058" {2}/>
<geom type="capsule" fromto="0 0 -0.05 0 0 -0.20" size="0.046" {4}/>
<geom type="cylinder" fromto="0 0 -0.19 0 0 -0.215" size="0.044" material="accent"/>
<body pos="0 0 -0.27">
<joint name="{1}_wrist_pitch" axis="0 -1 0" range="-1.2 1.2" armature="0.05"/>
<joint name="{1}_wrist_yaw" axis="{3} 0 0" range="-1.2 1.2" armature="0.05"/>
<geom type="sphere" size="0.036" {2}/>
{5}</body></body></body>
)",
      left * kShoulder_y_m, side, kJointLook, left, kShell, hand(side, -left));
}

std::string head() {
  std::string text = fmt::format(
      R"(<body name="neck" pos="0 0 0.52">
<joint name="neck_yaw" axis="0 0 1" range="-1.1 1.1" armature="0.05"/>
<geom type="cylinder" fromto="0 0 -0.04 0 0 0.07" size="0.042" {0}/>
<body name="head" pos="0 0 {1}">
<joint name="neck_pitch" axis="0 1 0" range="-0.6 1.3" armature="0.05"/>
<geom type="ellipsoid" pos="0.005 0 0.085" size="0.100 0.086 0.120" {2}/>
<geom type="ellipsoid" pos="0.038 0 0.090" size="0.074 0.078 0.058" material="visor"/>
<geom type="cylinder" fromto="0 -0.092 0.08 0 0.092 0.08" size="0.034" material="accent"/>
)",
      kJointLook, kNeck_z_m, kShell);
  // The cameras look along the head's x axis.
  for (const double left : {1.0, -1.0})
    text += fmt::format(
        R"(<geom type="cylinder" fromto="0.08 {0} {1} 0.108 {0} {1}" size="0.017" {2}/>
<camera name="{3}" pos="{4} {0} {1}" xyaxes="0 -1 0 0 0 1" fovy="{5}"/>
)",
        0.5 * left * kBaseline_m, kEye_z_m, kJointLook, left > 0 ? "left" : "right", kEye_x_m,
        kFieldOfView_rad * 180 / std::numbers::pi);
  return text + "</body></body>\n";
}

}  // namespace

void add_robot(ModelText& text) {
  text.assets += R"(<material name="shell" rgba="0.86 0.87 0.88 1" specular="0.5" shininess="0.6"/>
<material name="joint" rgba="0.20 0.21 0.23 1" specular="0.4" shininess="0.5"/>
<material name="accent" rgba="0.10 0.48 0.46 1" specular="0.5" shininess="0.6"/>
<material name="visor" rgba="0.05 0.06 0.08 1" specular="0.9" shininess="0.9"/>
)";
  text.bodies += fmt::format(
      R"(<body name="platform">
<joint name="platform_x" type="slide" axis="1 0 0" armature="20"/>
<joint name="platform_y" type="slide" axis="0 1 0" armature="20"/>
<joint name="platform_yaw" axis="0 0 1" armature="5"/>
<geom type="cylinder" fromto="0 0 0.05 0 0 0.22" size="0.27" {0}/>
<geom type="cylinder" fromto="0 0 0.10 0 0 0.13" size="0.273" material="accent"/>
<geom type="cylinder" fromto="0 0 0.02 0 0 0.05" size="0.25" {1}/>
<geom type="box" pos="-0.06 0 0.50" size="0.09 0.10 0.30" {1}/>
<body name="torso" pos="-0.04 0 {2}">
<joint name="torso_lift" type="slide" axis="0 0 1" range="-0.10 0.30" armature="8"/>
<joint name="torso_pitch" axis="0 1 0" range="-0.1 0.6" armature="2"/>
<joint name="torso_yaw" axis="0 0 1" range="-0.8 0.8" armature="2"/>
<geom type="capsule" fromto="0 0 -0.05 0 0 0.12" size="0.085" {1}/>
<geom type="ellipsoid" pos="0 0 0.31" size="0.125 0.165 0.190" {0}/>
<geom type="box" pos="0.085 0 0.34" size="0.035 0.075 0.06" material="accent"/>
<geom type="capsule" fromto="0 -0.16 0.42 0 0.16 0.42" size="0.065" {1}/>
)",
      kShell, kJointLook, kTorso_z_m);
  text.bodies += head() + arm("left", 1) + arm("right", -1) + "</body></body>\n";
}

}  // namespace engram::datasets::kitchen
