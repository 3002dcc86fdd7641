// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/idf/binary.h"

namespace engram::idf {

/// encode_into() for bytes that this processor is not going to read soon: large arrays are written
/// past its caches, see copy_past_caches(). An array whose bytes lie where they go is not copied.
Status encode_past_caches(const Data& data, std::span<std::byte> out, int max_depth = kMaxDepth);

}  // namespace engram::idf
