// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/memory/query.h"

namespace engram::ltm {

/// The times of an entity's snapshots. They are searched and not listed, because there may be
/// millions.
class Moments {
 public:
  virtual ~Moments() = default;

  /// The first and the last snapshot; nothing where the entity has none.
  /// Errors, here and below: kDataLoss, kUnavailable.
  virtual Result<std::optional<Time>> first() = 0;
  virtual Result<std::optional<Time>> last() = 0;

  /// The snapshot closest to `time` on that side, `time` included; nothing where there is none.
  virtual Result<std::optional<Time>> at_or_after(Time time) = 0;
  virtual Result<std::optional<Time>> at_or_before(Time time) = 0;

  /// The snapshot at `index`, counted from the first; nothing beyond the last.
  virtual Result<std::optional<Time>> nth(uint64_t index) = 0;
};

/// Moments in a list, which copies share.
class ListedMoments final : public Moments {
 public:
  /// `times` increase.
  explicit ListedMoments(std::vector<Time> times)
      : times_(std::make_shared<const std::vector<Time>>(std::move(times))) {}

  Result<std::optional<Time>> first() override { return nth(0); }
  Result<std::optional<Time>> last() override {
    return times_->empty() ? std::nullopt : std::optional(times_->back());
  }
  Result<std::optional<Time>> at_or_after(Time time) override;
  Result<std::optional<Time>> at_or_before(Time time) override;
  Result<std::optional<Time>> nth(uint64_t index) override {
    return index < times_->size() ? std::optional((*times_)[index]) : std::nullopt;
  }

 private:
  std::shared_ptr<const std::vector<Time>> times_;
};

/// The snapshots that a selector selects of one entity.
struct Selection {
  /// All snapshots from `first` to `last`, which both are times of snapshots.
  struct Span {
    Time first{};
    Time last{};

    friend bool operator==(const Span&, const Span&) = default;
  };
  std::optional<Span> snapshots;
  /// A moment after the last snapshot, to be predicted.
  std::optional<Time> future;

  friend bool operator==(const Selection&, const Selection&) = default;
};

/// Lists the snapshots of an entity that meet conditions: their times, increasing. Whoever knows
/// places and links gives it; without it conditions are refused.
using ListMoments = std::function<Result<std::vector<Time>>(std::span<const Condition> conditions)>;

/// One selected snapshot.
struct SelectedSnapshot {
  Time time{};
  bool is_future = false;  ///< After the last snapshot: to be predicted.
  /// The selected instances, increasing; empty: all.
  std::vector<int32_t> instances;

  friend bool operator==(const SelectedSnapshot&, const SelectedSnapshot&) = default;
};

/// Applies `selector` to the snapshots of an entity.
/// Errors: those of Moments.
/// Complexity: a few searches; for `Latest n` and index ranges as many as the distance of the index
/// from the end.
Result<Selection> select_times(const Selector& selector, Moments& moments);

/// Returns kInvalidArgument if a query has conditions, for who selects without knowing places and
/// links. `who` begins the message: "reflect".
[[nodiscard]] Status refuse_conditions(std::span<const SnapshotQuery> queries,
                                       std::string_view who);

/// Unites the snapshots that several selectors select of one entity: ordered by time, each moment
/// once, with all instances that any of them selects.
/// Errors: those of Moments and of `listed`; kInvalidArgument if there are conditions and no
/// `listed`.
/// Complexity: O(m log m) in the number m of selected snapshots.
Result<std::vector<SelectedSnapshot>> select_snapshots(std::span<const SnapshotQuery> queries,
                                                       Moments& moments,
                                                       const ListMoments& listed = {});

/// What select_snapshots() lists, without the list: there may be millions of snapshots. What is
/// selected is settled when it is created; snapshots that come later count where they lie between
/// others.
///
/// Threading: immutable.
class SelectedMoments {
 public:
  /// Errors: those of select_snapshots().
  static Result<SelectedMoments> create(std::span<const SnapshotQuery> queries, Moments& moments,
                                        const ListMoments& listed = {});

  /// The first selected snapshot of the past after `time`, or the first one of all.
  /// Errors: those of Moments.
  /// Complexity: a search for each selector.
  Result<std::optional<SelectedSnapshot>> after(std::optional<Time> time, Moments& moments) const;

  /// Moments after the last snapshot, to be predicted: ordered by time, each once.
  [[nodiscard]] const std::vector<SelectedSnapshot>& future() const { return future_; }

 private:
  struct Part {
    Selection::Span span;
    std::vector<int32_t> instances;
    std::optional<ListedMoments> listed;  ///< Those that meet its conditions, if it has some.
  };

  /// The next one of a part after `time`, or its first one.
  static Result<std::optional<Time>> next_of(const Part& part, std::optional<Time> time,
                                             Moments& moments);

  std::vector<Part> parts_;
  std::vector<SelectedSnapshot> future_;
};

}  // namespace engram::ltm
