// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "store/stream.h"

namespace engram::experiments {

/// Reads every snapshot of a store and compares it bit by bit with the stream.
/// Errors: those of StoreReader; kDataLoss naming the first snapshot that differs, or if the store
/// does not hold exactly `snapshots`.
Status verify_store(const std::filesystem::path& store, const Stream& stream, uint64_t snapshots);

/// Counts the snapshots in all commits of the stream.
[[nodiscard]] uint64_t count_snapshots(const Stream& stream);

}  // namespace engram::experiments
