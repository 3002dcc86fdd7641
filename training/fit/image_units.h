// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/network_shape.h"

namespace engram::training {

inline constexpr double kBitsOfKilobyte = 8000;

/// Number of elements of all images of a value, in images of 128 x 128 pixels with three channels.
/// The loss divides bits by it, because errors are means.
[[nodiscard]] double size_in_usual_images(const encoders::NetworkShape& shape);

}  // namespace engram::training
