// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: reads the snapshots of an entity and calculates their parts.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ltm/likeness/stored_codes.h"
#include "ltm/recall/store_past.h"
#include "ltm/saliency/change_meter.h"
#include "ltm/saliency/member_units.h"
#include "ltm/saliency/moment_content.h"
#include "ltm/saliency/stored_saliency.h"

namespace engram::ltm {

/// Reads what the snapshots of one entity say. Images are told by their codes (docs/recall.md),
/// where there are some; without codes by the numbers and texts beside them. Of a snapshot with a
/// code of which only latents are left, numbers that lie in them are not decoded.
///
/// Threading: one thread.
class EntityContents {
 public:
  /// Errors: those of reading. `past` must outlive it.
  static Result<std::unique_ptr<EntityContents>> open(StorePast& past, const MemoryId& entity);

  /// Reads a snapshot. False if it is damaged, or if there is nothing in it.
  /// Errors: those of reading but for kDataLoss.
  Result<bool> read(const SnapshotEntry& entry);

  /// What was read last. Valid until read().
  [[nodiscard]] const MomentContent& content() const { return reader_.content(); }
  [[nodiscard]] const std::vector<ContentMember>& members() const { return reader_.members(); }

 private:
  EntityContents(StorePast& past, MemoryId entity, std::optional<idf::Type> type)
      : past_(past), entity_(std::move(entity)), reader_(std::move(type)) {}
  Status read_values(const SnapshotEntry& entry);
  Status read_latents(const SnapshotEntry& entry, bool has_code);

  StorePast& past_;
  MemoryId entity_;
  ContentReader reader_;
  std::optional<StoredCodes> codes_;
  std::unique_ptr<EntityPast> decoded_;
};

/// Gathers the units of all entities of one provider segment, from at most 4,096 pairs of
/// consecutive snapshots, evenly spread. Entities that cannot be read tell nothing. `is_over` is
/// asked before each entity; once it says so, the rest is left out.
/// Errors: kUnavailable, kResourceExhausted.
Result<MemberUnits> measure_units(StorePast& past, std::span<const MemoryId> entities,
                                  const std::function<bool()>& is_over);

/// Takes what was found of a snapshot.
using TakeRow = std::function<Status(const SnapshotEntry& entry, const SaliencyRow& row)>;

/// Calculates the parts of the snapshots of an entity from the one at `first` on, in the order of
/// time. Those before it are looked at for what they tell of it. Damaged ones have no parts.
/// `is_over` is asked before each; once it says so, the rest is left out.
/// Errors: those of reading and of `take`.
/// Complexity: O(N (log N + 256) D); 64 MiB of memory.
Status score_entity(StorePast& past, const MemoryId& entity, const MemberUnits& units,
                    std::span<const SnapshotEntry> entries, size_t first,
                    const std::function<bool()>& is_over, const TakeRow& take);

/// A series that grows by what is read, in member units.
class SeriesBuilder {
 public:
  explicit SeriesBuilder(const MemberUnits& units) : units_(units) {}

  /// `follows`: no snapshot of the entity lies between the last one and this one.
  /// False if the content has other members than the series; then nothing is added.
  bool add(Time time, const std::vector<ContentMember>& members, const MomentContent& content,
           bool follows);

  /// Leaves the last `count` snapshots. The members and the reference stay.
  void keep_last(size_t count);
  /// Leaves nothing; the next snapshot may have any members.
  void clear();

  [[nodiscard]] const ContentSeries& series() const { return series_; }
  /// How much of a member makes a unit. Shape: [D].
  [[nodiscard]] const std::vector<double>& units() const { return scales_; }
  /// What is subtracted from all rows, in the member's own unit. Shape: [D].
  [[nodiscard]] const std::vector<double>& reference() const { return reference_; }

 private:
  const MemberUnits& units_;
  bool has_members_ = false;
  ContentSeries series_;
  std::vector<double> scales_, reference_, last_;
};

}  // namespace engram::ltm
