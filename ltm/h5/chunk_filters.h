// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: what h5py does to chunks, undone without HDF5, which reads beyond those that
// unpack to less than it expects.

#include "ltm/h5/raw_file.h"

namespace engram::h5 {

enum class ChunkFilter : uint8_t { kDeflate, kShuffle, kFletcher32 };

/// Undoes `filters` (in the order in which they were done) of a stored chunk. Bit i of `skipped`
/// says that filter i was not done.
/// Errors: kDataLoss where the chunk is damaged or is not of `chunk_bytes`.
Result<RawBytes> unfiltered_chunk(RawBytes stored, const std::vector<ChunkFilter>& filters,
                                  uint32_t skipped, uint64_t chunk_bytes, uint64_t element_bytes);

}  // namespace engram::h5
