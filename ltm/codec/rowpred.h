// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Images by row prediction and entropy coding, for recording at speed: uint8 or uint16
/// [H, W, 1 to 4], of which the first three are RGB, and depth as float32 [H, W, 1]. Lossless.
/// "rowpred"; no options.
/// Errors: kInvalidArgument for options.
/// Source: docs/codecs.md, section "rowpred".
Result<std::unique_ptr<const Codec>> make_rowpred_codec(CodecText text);

}  // namespace engram::ltm
