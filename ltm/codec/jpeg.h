// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Stores images as JPEG files: uint8 [H, W, 3] (RGB; colour at half the resolution) or [H, W, 1].
/// Lossy.
/// The text is "jpeg:quality=1..100"; the default is 90.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_jpeg_codec(CodecText text);

}  // namespace engram::ltm
