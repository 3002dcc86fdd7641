// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the kitchen as a MuJoCo document.

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/kitchen/drawing_size.h"
#include "datasets/kitchen/kitchen_layout.h"

namespace engram::datasets::kitchen {

/// A picture that the model names. MuJoCo gets its pixels after the model is compiled.
struct Texture {
  std::string name;
  bool is_cube = false;  ///< Six faces stacked vertically.
  cv::Mat pixels;        ///< CV_8UC3, RGB.
};

/// A geom that others can touch.
struct Solid {
  std::string name;
  bool is_loose = false;  ///< It moves by itself.
};

/// Parts of an MJCF document.
struct ModelText {
  bool is_painted = true;  ///< False: materials have no pictures.
  std::string assets;
  std::string bodies;
  std::string constraints;
  /// The geoms that can touch each other, in the order of their bodies.
  std::vector<Solid> solids;
  std::vector<Texture> textures;

  /// Notes a solid, and returns what makes a geom one.
  std::string solid(std::string_view name, bool is_loose);

  /// Adds a picture, CV_8UC3 in RGB, with a material of the same name. `repeat_x` and `repeat_y`
  /// are the repetitions along the axes of a geom. `paint` is called only where it is painted.
  void add_material(const std::string& name, const std::function<cv::Mat()>& paint,
                    bool is_cube = false, double repeat_x = 1, double repeat_y = 1,
                    const std::string& attributes = "");
};

/// Adds walls, furniture and lights. This and the next functions throw cv::Exception.
void add_room(const Layout& layout, ModelText& text);
/// Adds the humanoid on its platform, with its cameras.
void add_robot(ModelText& text);
/// Adds objects, and constraints "left:NAME" and "right:NAME" that fix them to a hand.
void add_things(const Layout& layout, ModelText& text);

/// Adds a chair and a person, outside of the room.
void add_movables(ModelText& text);

/// Returns the whole document.
[[nodiscard]] std::string document_of(const ModelText& text, const DrawingSize& size,
                                      const Layout& layout);

}  // namespace engram::datasets::kitchen
