// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Any ndarray as it lies, through Zstandard. Lossless. "zstd:level=1..19", 3 by default.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_zstd_codec(CodecText text);

/// The one with default options.
[[nodiscard]] const Codec& zstd_codec();

}  // namespace engram::ltm
