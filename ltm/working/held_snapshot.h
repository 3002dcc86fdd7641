// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// A snapshot of working memory, and the bytes as which it came.
struct HeldSnapshot : Snapshot {
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

}  // namespace engram::ltm
