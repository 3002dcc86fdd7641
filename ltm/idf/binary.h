// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/idf/data.h"

namespace engram::idf {

/// The bound of nested lists and dicts in the binary and JSON forms.
inline constexpr int kMaxDepth = 64;

/// The exact number of bytes that `encode` writes.
[[nodiscard]] size_t encoded_size(const Data& data);

/// The levels that a container of this program may add around a value. Writer and reader must both
/// be told.
inline constexpr int kContainerDepth = 8;

/// Writes the binary form, version 1: little-endian, ndarrays aligned to 8 bytes from the start.
///
/// Errors: kInvalidArgument where the value nests deeper than `max_depth`.
/// Source: docs/format.md, section "IDF binary form".
Result<std::vector<std::byte>> encode(const Data& data, int max_depth = kMaxDepth);

/// Writes the binary form into memory of the caller, which must be aligned to 8 bytes and have
/// exactly encoded_size(data) bytes (checked).
Status encode_into(const Data& data, std::span<std::byte> out, int max_depth = kMaxDepth);

/// Reads the binary form. ndarrays view `buffer` where its start is aligned to 8 bytes (as every
/// allocation is); they are copied otherwise.
///
/// Safe on hostile bytes: depth, counts and lengths are checked before anything is allocated.
/// Errors: kDataLoss naming the offset, what was found and what was needed.
Result<Data> decode(const Buffer& buffer, int max_depth = kMaxDepth);

}  // namespace engram::idf
