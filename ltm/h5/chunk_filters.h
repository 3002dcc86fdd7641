// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to ltm/h5: undoes the filters of chunks without HDF5, which reads out of bounds if a
// chunk unpacks to fewer bytes than expected.

#include "ltm/h5/raw_file.h"

namespace engram::h5 {

enum class ChunkFilter : uint8_t { kDeflate, kShuffle, kFletcher32 };

/// Undoes `filters`, given in the order in which they were applied, of a stored chunk. Bit i of
/// `skipped` is set if filter i was not applied.
/// Errors: kDataLoss if the chunk is damaged or does not have `chunk_bytes`.
Result<RawBytes> unfiltered_chunk(RawBytes stored, const std::vector<ChunkFilter>& filters,
                                  uint32_t skipped, uint64_t chunk_bytes, uint64_t element_bytes);

}  // namespace engram::h5
