// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Compresses any ndarray by a byte shuffle and Zstandard; meant for float arrays and point clouds.
/// Lossless. A record of the shuffle is an element, or a row of up to 16 elements (the fields of a
/// point).
/// The text is "shuffle:level=1..19"; the default is 3.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_shuffle_codec(CodecText text);

}  // namespace engram::ltm
