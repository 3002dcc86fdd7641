// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/memory/checked_snapshot.h"
#include "ltm/memory/result.h"

namespace engram::ltm {

/// A checked snapshot of working memory, and the bytes in which it came. check() makes it.
struct HeldSnapshot : CheckedSnapshot {
  /// `came` is dropped where values were cast, because it holds the values before the cast.
  HeldSnapshot(Proof proof, const SnapshotCast& cast, std::vector<Buffer> came)
      : CheckedSnapshot(std::move(proof), cast),
        encoded(cast.is_cast ? std::vector<Buffer>() : std::move(came)) {}

  /// The data of each instance in IDF's binary form; empty where it did not come in this form.
  std::vector<Buffer> encoded;

  /// What it takes in RAM: the bytes in which it came or the elements of its arrays, the values
  /// made of them, and kSnapshotOverhead. Unit: bytes.
  [[nodiscard]] size_t ram_bytes() const;

  /// The size of its data: of the bytes in which it came, otherwise of its values. Unit: bytes.
  [[nodiscard]] size_t plain_bytes() const {
    if (encoded.empty()) return raw_bytes();
    size_t bytes = 0;
    for (const Buffer& data : encoded) bytes += data.size();
    return bytes;
  }
};

/// A snapshot that is shared with its readers and never changes.
using SharedSnapshot = std::shared_ptr<const HeldSnapshot>;

/// Holds a snapshot whose segment has no type.
[[nodiscard]] SharedSnapshot hold_untyped(Snapshot snapshot, std::vector<Buffer> encoded = {});

/// Returns a snapshot as a moment of an answer. `instances` selects instances, increasing; empty:
/// all. Where it has none of these, the moment has no instances.
[[nodiscard]] SnapshotResult result_of(const HeldSnapshot& held,
                                       const std::vector<int32_t>& instances, bool is_ids_only);

}  // namespace engram::ltm
