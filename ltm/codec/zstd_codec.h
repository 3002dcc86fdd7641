// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"
#include "ltm/codec/codec_text.h"

namespace engram::ltm {

/// Compresses the unchanged bytes of any ndarray with Zstandard. Lossless. The text is
/// "zstd:level=1..19"; the default is 3.
/// Errors: kInvalidArgument for other options.
Result<std::unique_ptr<const Codec>> make_zstd_codec(CodecText text);

/// The codec with default options.
[[nodiscard]] const Codec& zstd_codec();

}  // namespace engram::ltm
