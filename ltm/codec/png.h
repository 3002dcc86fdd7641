// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"

namespace engram::ltm {

/// Images as PNG: uint8 [H, W, 3] (RGB), uint8 or uint16 [H, W, 1]. Lossless.
[[nodiscard]] const Codec& png_codec();

}  // namespace engram::ltm
