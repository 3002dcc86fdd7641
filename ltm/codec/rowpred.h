// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Compresses images by row prediction and entropy coding, fast enough for recording: uint8 or
/// uint16 [H, W, 1 to 4], of which the first three channels are RGB, and depth as float32 [H, W,
/// 1]. Lossless.
/// The text is "rowpred"; it has no options.
/// Errors: kInvalidArgument for options.
/// Source: docs/codecs.md, section "rowpred".
Result<std::unique_ptr<const Codec>> make_rowpred_codec(CodecText text);

}  // namespace engram::ltm
