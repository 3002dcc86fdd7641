// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/prediction/number_series.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// Tells when a member of an entity's values moves.
///
/// The error of an engine while a member moves says nothing about its error at rest, and most
/// things are at rest most of the time: an object that is carried for a minute a day would be
/// predicted by the engine that copies best. So both kinds of moments are measured apart.
/// A member moves at a row if it changed since the row before by more than kShare of its usual
/// change (the root mean square over the series). So sensor noise does not count as movement of a
/// thing that is carried now and then, and a thing that never rests moves all the time.
/// Threading: immutable; the series may grow.
/// Source: docs/prediction.md, section "Which engine answers".
class MemberMotion {
 public:
  static constexpr double kShare = 0.1;

  /// Computes the usual changes from all rows that the series has now.
  MemberMotion(const NumberSeries& series, const std::vector<RowMember>& members);

  /// False at the first row of a run, which has no row before it.
  [[nodiscard]] bool is_moving(const NumberSeries& series, size_t row, const RowMember& member,
                               size_t index) const;

 private:
  std::vector<double> thresholds_;  ///< Mean squares of changes, one per member.
};

}  // namespace engram::ltm
