// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/recall/access_table.h"
#include "ltm/recall/recall.h"

namespace engram::ltm {

/// What policies may ask about the snapshots of one generation of a store.
///
/// Threading: one thread.
class ForgetSource {
 public:
  /// Latents whose values are asked for need a `recall` with a loader. Both outlive this.
  ForgetSource(Recall& recall, const AccessTable& accesses)
      : recall_(recall), accesses_(accesses) {}

  [[nodiscard]] StoreReader& store() { return recall_.store(); }

  /// Reads that were noted of a snapshot.
  [[nodiscard]] AccessStats accesses(const MemoryId& entity, Time snapshot) const {
    return accesses_.find(entity, snapshot);
  }

  /// The confidence of the instance that has most; nothing decoded.
  /// Errors: those of StoreReader.
  Result<double> confidence(const MemoryId& entity, const SnapshotEntry& entry);

  /// The values, latents decoded.
  /// Errors: those of Recall::query.
  Result<Snapshot> read(const MemoryId& entity, const SnapshotEntry& entry);

  /// The snapshots that a snapshot's values name. Of latents only what is no tensor is looked at:
  /// links are texts.
  /// Errors: those of StoreReader.
  Result<std::vector<MemoryId>> links(const MemoryId& entity, const SnapshotEntry& entry);

 private:
  Recall& recall_;
  const AccessTable& accesses_;
};

}  // namespace engram::ltm
