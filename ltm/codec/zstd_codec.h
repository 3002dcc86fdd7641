// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ltm/codec/codec.h"

namespace engram::ltm {

/// Any ndarray as it lies, through Zstandard. Lossless.
[[nodiscard]] const Codec& zstd_codec();

}  // namespace engram::ltm
