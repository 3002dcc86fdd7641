// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "training/measure/prediction_quality.h"

// Private to this room.

namespace engram::reports {

/// "95.6 %", and how many bounds say nothing, if any; "-" without bounds.
std::string within_text(const training::Coverage& told);

/// How far bounds lie from what is expected: "3.46 dB" for images, "x 2.10" for numbers; "-" if
/// that is not known.
std::string image_width_text(const training::Coverage& told);
std::string number_width_text(const training::Coverage& told);

}  // namespace engram::reports
