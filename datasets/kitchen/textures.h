// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: pictures on surfaces, painted by code. Throws cv::Exception.

#include <opencv2/core.hpp>

#include "datasets/kitchen/things.h"

namespace engram::datasets::kitchen {

/// All results are CV_8UC3 in RGB order; equal arguments give equal pixels.

/// Paints boards of wood along the rows of the image. `tone`: from -1, dark, to 1, light.
[[nodiscard]] cv::Mat paint_wood(int side, int boards, double tone, uint64_t seed);
[[nodiscard]] cv::Mat paint_floor_tiles(int side, uint64_t seed);
/// Paints glazed tiles with joints; every other row is shifted.
[[nodiscard]] cv::Mat paint_wall_tiles(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_plaster(int side, cv::Scalar colour, uint64_t seed);
[[nodiscard]] cv::Mat paint_stone(int side, uint64_t seed);
/// Paints the door of a cupboard: a frame around a panel.
[[nodiscard]] cv::Mat paint_door(int side, cv::Scalar colour, uint64_t seed);
/// Paints a garden under the sky, seen through a window.
[[nodiscard]] cv::Mat paint_garden(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_stove(int side);
[[nodiscard]] cv::Mat paint_cloth(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_brushed_steel(int side, uint64_t seed);

/// Paints the six faces of a thing, stacked vertically: +x, -x, +y, -y, +z, -z of the thing.
/// Shape: [6 side, side].
[[nodiscard]] cv::Mat paint_thing(const ThingClass& type, int side, uint64_t seed);

}  // namespace engram::datasets::kitchen
