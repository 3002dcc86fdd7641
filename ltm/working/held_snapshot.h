// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/memory/checked_snapshot.h"
#include "ltm/memory/result.h"

namespace engram::ltm {

/// A snapshot of working memory, checked, and the bytes as which it came. check() makes it.
struct HeldSnapshot : CheckedSnapshot {
  /// `came` is forgotten where values were cast: it says what they were before.
  HeldSnapshot(Proof proof, const SnapshotCast& cast, std::vector<Buffer> came)
      : CheckedSnapshot(std::move(proof), cast),
        encoded(cast.is_cast ? std::vector<Buffer>() : std::move(came)) {}

  /// The data of each instance in IDF's binary form; empty where it did not come so.
  std::vector<Buffer> encoded;

  /// Of its data: as it came, else as values.
  [[nodiscard]] size_t plain_bytes() const {
    if (encoded.empty()) return raw_bytes();
    size_t bytes = 0;
    for (const Buffer& data : encoded) bytes += data.size();
    return bytes;
  }
};

/// A snapshot that is shared with whoever reads it, and never changes.
using SharedSnapshot = std::shared_ptr<const HeldSnapshot>;

/// A snapshot whose segment has no type.
[[nodiscard]] SharedSnapshot hold_untyped(Snapshot snapshot, std::vector<Buffer> encoded = {});

/// A snapshot as a moment of an answer; `instances`: which, increasing, empty for all. Without any
/// of these it has no instances.
[[nodiscard]] SnapshotResult result_of(const HeldSnapshot& held,
                                       const std::vector<int32_t>& instances, bool is_ids_only);

}  // namespace engram::ltm
