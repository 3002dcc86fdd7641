// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/model_text.h"

#include <fmt/format.h>

#include <utility>

namespace engram::datasets::kitchen {

void ModelText::add_material(const std::string& name, const std::function<cv::Mat()>& paint,
                             bool is_cube, double repeat_x, double repeat_y,
                             const std::string& attributes) {
  if (!is_painted) {
    assets += fmt::format("<material name=\"{}\" {}/>\n", name, attributes);
    return;
  }
  cv::Mat pixels = paint();
  assets += fmt::format(
      R"(<texture name="{0}" type="{1}" builtin="flat" width="{2}" height="{3}"/>
<material name="{0}" texture="{0}" texrepeat="{4} {5}" {6}/>
)",
      name, is_cube ? "cube" : "2d", pixels.cols, pixels.rows, repeat_x, repeat_y, attributes);
  textures.push_back({name, is_cube, std::move(pixels)});
}

std::string ModelText::solid(std::string_view name, bool is_loose) {
  solids.push_back({std::string(name) + "_solid", is_loose});
  return fmt::format(R"(class="solid" name="{}")", solids.back().name);
}

namespace {

/// The pairs of solids that can touch. MuJoCo would find them by itself, but it would try all geoms
/// of the room with all of a thing first, at every step: that took almost half of its time.
///
/// It takes how a pair touches from one of its geoms. Here that is what it would have made of both:
/// the higher friction, and the mean of the times in which a contact gives way.
std::string pairs_of(const std::vector<Solid>& solids) {
  std::string pairs;
  for (size_t i = 0; i < solids.size(); ++i)
    for (size_t k = i + 1; k < solids.size(); ++k) {
      const bool are_loose = solids[i].is_loose && solids[k].is_loose;
      if (!solids[i].is_loose && !solids[k].is_loose) continue;
      pairs += fmt::format(
          R"(<pair geom1="{}" geom2="{}" friction="{} 0.01 0.001 0.001" solref="{} 1"/>
)",
          solids[i].name, solids[k].name, are_loose ? "0.9 0.9" : "1 1",
          are_loose ? "0.008" : "0.014");
    }
  return pairs;
}

}  // namespace

std::string document_of(const ModelText& text, const DrawingSize& size, const Layout& layout) {
  const Lighting& light = layout.light;
  const double ambient = 0.33 + 0.20 * light.daylight;
  // The image is twice as wide, because both images of the stereo pair are drawn side by side.
  return fmt::format(
      R"(<mujoco model="kitchen">
<compiler angle="radian" autolimits="true" inertiafromgeom="true"/>
<option timestep="0.002" cone="elliptic" impratio="3" collision="predefined"/>
<size nconmax="300" njmax="1500"/>
<statistic extent="1" center="0 0.5 0.8"/>
<visual>
  <global offwidth="{}" offheight="{}"/>
  <quality shadowsize="{}" offsamples="{}"/>
  <map znear="0.03" zfar="12" shadowscale="0.85"/>
  <headlight ambient="{} {} {}" diffuse="0.14 0.14 0.14" specular="0 0 0"/>
</visual>
<default>
  <geom contype="0" conaffinity="0" density="400"/>
  <default class="solid"><geom contype="1" conaffinity="1" group="3"/></default>
</default>
<asset>
{}</asset>
<worldbody>
{}</worldbody>
<contact>
{}</contact>
<equality>
{}</equality>
</mujoco>
)",
      2 * size.width, size.height, size.shadow_map > 0 ? size.shadow_map : 64, size.samples,
      ambient, ambient, ambient * (1.0 - 0.12 * light.warmth), text.assets, text.bodies,
      pairs_of(text.solids), text.constraints);
}

}  // namespace engram::datasets::kitchen
