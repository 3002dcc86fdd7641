// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/prediction/number_series.h"
#include "ltm/prediction/value_row.h"

namespace engram::ltm {

/// Tells when a member of an entity's values moves.
///
/// What an engine is worth for something that moves says nothing of it at rest, and most things are
/// at rest most of the time: an object that is carried for a minute a day would be predicted by
/// whatever copies best. So moments of both kinds are measured apart.
/// A member moves at a row where it changed since the row before by more than kShare of its usual
/// change (the root mean square over the series): noise of a sensor is no movement of a thing that
/// is carried now and then, while a thing that never rests moves all the time.
/// Threading: immutable; the series may grow.
/// Source: docs/prediction.md, section "Which engine answers".
class MemberMotion {
 public:
  static constexpr double kShare = 0.1;

  /// From all rows that the series has now.
  MemberMotion(const NumberSeries& series, const std::vector<RowMember>& members);

  /// False at the first row of a run: nothing tells.
  [[nodiscard]] bool is_moving(const NumberSeries& series, size_t row, const RowMember& member,
                               size_t index) const;

 private:
  std::vector<double> thresholds_;  ///< Mean squares of changes, by index of the member.
};

}  // namespace engram::ltm
