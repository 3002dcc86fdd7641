// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "ltm/recall/access_table.h"
#include "ltm/recall/recall.h"
#include "ltm/saliency/saliency_table.h"

namespace engram::ltm {

/// Gives policies the data of snapshots in one generation of a store.
///
/// Threading: one thread.
class ForgetSource {
 public:
  /// To read values of latents, `recall` needs a loader. Both must outlive this. After `stop` each
  /// read fails with kCancelled, so that policies that read much end soon.
  ForgetSource(Recall& recall, const AccessTable& accesses, std::stop_token stop = {})
      : recall_(recall), accesses_(accesses), stop_(std::move(stop)) {}

  [[nodiscard]] StoreReader& store() { return recall_.store(); }

  /// The noted reads of a snapshot.
  [[nodiscard]] AccessStats accesses(const MemoryId& entity, Time snapshot) const {
    return accesses_.find(entity, snapshot);
  }

  /// The saliency of all snapshots. It is read when it is asked for first.
  const SaliencyTable& saliency();

  /// See SaliencyTable::cut_for. It is calculated once for each pattern and share.
  SaliencyCut saliency_cut(const EntityPattern& match, double share);

  /// The highest confidence of an instance. Decodes nothing.
  /// Errors: those of StoreReader.
  Result<double> confidence(const MemoryId& entity, const SnapshotEntry& entry);

  /// Reads the values and decodes latents.
  /// Errors: those of Recall::query.
  Result<Snapshot> read(const MemoryId& entity, const SnapshotEntry& entry);

  /// The snapshots that a snapshot's values link to. Links are texts, so of latents it reads only
  /// what is not a tensor.
  /// Errors: those of StoreReader.
  Result<std::vector<MemoryId>> links(const MemoryId& entity, const SnapshotEntry& entry);

 private:
  [[nodiscard]] Status check_stop() const;

  Recall& recall_;
  const AccessTable& accesses_;
  std::stop_token stop_;
  std::optional<SaliencyTable> saliency_;
  std::map<std::pair<std::string, double>, SaliencyCut> cuts_;
};

}  // namespace engram::ltm
