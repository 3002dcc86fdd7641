// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: pictures on surfaces, painted in code. Throws cv::Exception.

#include <opencv2/core.hpp>

#include "datasets/kitchen/things.h"

namespace engram::datasets::kitchen {

/// All are CV_8UC3 in RGB order; equal arguments give equal pixels.

/// Boards of wood along the image's rows. `tone`: -1 (dark) to 1 (light).
[[nodiscard]] cv::Mat paint_wood(int side, int boards, double tone, uint64_t seed);
[[nodiscard]] cv::Mat paint_floor_tiles(int side, uint64_t seed);
/// Glazed tiles with joints, those of every other row shifted.
[[nodiscard]] cv::Mat paint_wall_tiles(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_plaster(int side, cv::Scalar colour, uint64_t seed);
[[nodiscard]] cv::Mat paint_stone(int side, uint64_t seed);
/// The door of a cupboard: a frame around a panel.
[[nodiscard]] cv::Mat paint_door(int side, cv::Scalar colour, uint64_t seed);
/// A garden under the sky, seen through a window.
[[nodiscard]] cv::Mat paint_garden(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_stove(int side);
[[nodiscard]] cv::Mat paint_cloth(int side, uint64_t seed);
[[nodiscard]] cv::Mat paint_brushed_steel(int side, uint64_t seed);

/// The six faces of a thing, one below the other: +x, -x, +y, -y, +z, -z of the thing.
/// Shape: [6 side, side].
[[nodiscard]] cv::Mat paint_thing(const ThingClass& type, int side, uint64_t seed);

}  // namespace engram::datasets::kitchen
