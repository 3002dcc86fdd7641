// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/recall/access_table.h"
#include "ltm/saliency/stored_saliency.h"
#include "ltm/store/store_reader.h"

namespace engram::ltm {

/// The weights that a store has; the standard ones if it has none, or if they are damaged.
[[nodiscard]] SaliencyWeights stored_weights(const std::filesystem::path& store);

/// The saliency of one segment; empty if there is none, or if it is damaged.
[[nodiscard]] SegmentSaliency saliency_of_segment(StoreReader& store, const SegmentInfo& segment);

/// Calls `take` with all rows of all segments that there are, segment by segment.
void for_each_saliency(StoreReader& store,
                       const std::function<void(uint32_t segment, EntitySaliency one)>& take);

/// The rows of all entities, those of each from all segments of a generation. Where a snapshot lies
/// in several segments, the newest counts. It takes 28 bytes of memory for each snapshot.
[[nodiscard]] std::map<MemoryId, EntitySaliency> all_saliency(StoreReader& store);

/// Puts snapshots of several segments in the order of time. Of equal ones the last one stays.
void sort_by_time(EntitySaliency& saliency);

/// The same of one entity.
[[nodiscard]] EntitySaliency stored_saliency_of(StoreReader& store, const MemoryId& entity);

/// Where the most salient snapshots end.
struct SaliencyCut {
  double below = 0;  ///< What has less goes.
  /// Share of those that have exactly as much that goes. Which of them is decided by their times,
  /// as by chance.
  double share_of_equal = 0;

  [[nodiscard]] bool takes(double saliency, Time time) const;
};

/// The saliency of all snapshots of a store that have one, as of now: reads and weights count that
/// are there when it is read. It takes 16 bytes of memory for each snapshot.
///
/// Threading: const-parallel.
class SaliencyTable {
 public:
  /// Indexes that are damaged or missing count as empty.
  static SaliencyTable read(StoreReader& store, const AccessTable& accesses);

  /// Nothing if no night has looked at the snapshot, or if it is damaged. Complexity: O(log N).
  [[nodiscard]] std::optional<double> find(const MemoryId& entity, Time time) const;

  /// How many snapshots have one.
  [[nodiscard]] size_t size() const;

  /// What goes if `share` of the snapshots of the entities that match is to stay, 0 to 1: of those
  /// that are there and those that they stand for. So what was cut once is not cut again.
  /// Complexity: O(N).
  [[nodiscard]] SaliencyCut cut_for(const EntityPattern& match, double share) const;

 private:
  struct Score {
    Time time{};
    float value = 0;
    uint32_t stands_for = 1;
  };
  std::map<MemoryId, std::vector<Score>> entities_;  ///< Each in the order of time.
};

}  // namespace engram::ltm
