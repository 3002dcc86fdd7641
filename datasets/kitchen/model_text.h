// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the kitchen as MuJoCo reads it.

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "datasets/kitchen/kitchen_layout.h"

namespace engram::datasets::kitchen {

/// A picture that the model names; MuJoCo gets its pixels after the model is compiled.
struct Texture {
  std::string name;
  bool is_cube = false;  ///< Six faces, one below the other.
  cv::Mat pixels;        ///< CV_8UC3, RGB.
};

/// Parts of an MJCF document.
struct ModelText {
  std::string assets;
  std::string bodies;
  std::string constraints;
  std::vector<Texture> textures;

  /// Adds a picture with a material of the same name. `repeat`: along both axes of a geom.
  void add_material(const std::string& name, cv::Mat pixels, bool is_cube = false,
                    double repeat_x = 1, double repeat_y = 1, const std::string& attributes = "");
};

/// Walls, furniture and lights. Throws cv::Exception, as do the others.
void add_room(const Layout& layout, ModelText& text);
/// The humanoid on its platform, with its cameras.
void add_robot(ModelText& text);
/// Objects, and constraints "left:NAME" and "right:NAME" that fix them to a hand.
void add_things(const Layout& layout, ModelText& text);

/// Size of the pictures that are to be drawn. Unit: pixels.
struct DrawingSize {
  int width = 640;
  int height = 480;
  int samples = 4;        ///< Per pixel; 0: none.
  int shadow_map = 2048;  ///< 0: no shadows.
};

/// The whole document.
[[nodiscard]] std::string document_of(const ModelText& text, const DrawingSize& size,
                                      const Layout& layout);

}  // namespace engram::datasets::kitchen
