// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the error of predictions of one step, over the bound that was told before.

#include <deque>
#include <vector>

#include "ltm/saliency/change_meter.h"

namespace engram::ltm {

/// A prediction and what came.
struct Surprise {
  double error = 0;          ///< Root mean square over all numbers. Unit: member units.
  double bound = 0;          ///< 90 % of the predictions before were no more wrong. Unit: the same.
  bool is_line = false;      ///< The last step was continued; otherwise the last value was held.
  size_t member = 0;         ///< The number that is most off, as an index into a row.
  double predicted = 0;      ///< What was told of it. Unit: member units.
  double changed_facts = 0;  ///< Share of the steps before in which texts changed.
  bool has_changed = false;  ///< Texts or links differ from those before.
  bool is_known = false;     ///< Enough came before.

  [[nodiscard]] double ratio() const { return bound > 0 ? error / bound : 0; }
  /// 0 to 1 (surprise_part); a text that changed counts by how seldom it did.
  [[nodiscard]] double part() const;
};

/// Predicts each snapshot of a series from those before, holding the last value or continuing its
/// last step, whichever was less wrong in the last 32 steps. What it says of a snapshot depends on
/// the 34 before it and on nothing else, so it can be told again later.
///
/// Threading: one thread.
/// Source: docs/saliency.md, section "Surprise"; bounds as in ltm/prediction/error_bound.h.
class SurpriseMeter {
 public:
  static constexpr size_t kWindow = 32;
  /// Snapshots before one that decide what is said of it.
  static constexpr size_t kReach = kWindow + 2;
  static constexpr size_t kMinErrors = 8;

  /// Judges the snapshot `at`, then learns from it. Give the snapshots of a series in their order.
  Surprise next(const ContentSeries& series, size_t at);

 private:
  struct Errors {
    double held = 0, line = 0;
    bool has_changed = false;
  };
  std::deque<Errors> window_;
  size_t seen_ = 0;
};

}  // namespace engram::ltm
