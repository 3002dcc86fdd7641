// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/checkpoint.h"
#include "training/fit/fit_state.h"
#include "training/fit/job_pace.h"
#include "training/fit/schedule.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// What happens between the steps of a fit: it ends when its time is over, stops, waits while the
/// robot is busy, is kept now and then, and goes on where an earlier process was.
///
///     FitState state{model, optimiser, now, numbers};
///     ENGRAM_RETURN_IF_ERROR(loop.begin(state));
///     for (;; ++now.step) {
///       ENGRAM_ASSIGN_OR_RETURN(const double share, loop.next(state));
///       if (share >= 1.0) break;
///       ...
///       loop.tell(now);
///     }
///
/// Threading: one thread.
class FitLoop {
 public:
  /// All but `sink` outlive it.
  FitLoop(FitPhase phase, Schedule& schedule, JobPace& pace, Checkpoints& checkpoints,
          StepSink sink);

  /// Puts back what an earlier process kept of this phase; or, where it was in a later one, its
  /// weights: then this phase is over at once.
  /// Errors: kDataLoss where what was kept does not fit; it is refused, and training has to begin
  /// anew, from the first phase on.
  Status begin(FitState& state);

  /// The share of the time that is over, before the next step: 1 and more at the end.
  /// Errors: those of JobPace::pause; the state is kept first.
  Result<double> next(const FitState& state);

  void tell(const FitStep& now) const;

 private:
  void keep(const FitState& state, double share);
  Status pause(const FitState& state, double share);

  FitPhase phase_;
  Schedule& schedule_;
  JobPace& pace_;
  Checkpoints& checkpoints_;
  StepSink sink_;
  bool is_over_ = false;
};

}  // namespace engram::training
