// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Stores images as PNG files: uint8 [H, W, 3] (RGB), uint8 or uint16 [H, W, 1]. Lossless.
/// The text is "png:level=0..9"; 1 is fast, 9 is small. Without a level, deflate looks for run
/// lengths only.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_png_codec(CodecText text);

/// The codec with default options.
[[nodiscard]] const Codec& png_codec();

}  // namespace engram::ltm
