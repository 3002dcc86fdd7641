// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Images as PNG files: uint8 [H, W, 3] (RGB), uint8 or uint16 [H, W, 1]. Lossless.
/// "png:level=0..9", 1 fast, 9 small; without a level, run lengths are all that deflate looks for.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_png_codec(CodecText text);

/// The one with default options.
[[nodiscard]] const Codec& png_codec();

}  // namespace engram::ltm
