// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "training/fit/checkpoint.h"
#include "training/fit/fit_state.h"
#include "training/fit/job_pace.h"
#include "training/fit/schedule.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Controls a fit between its steps. It ends the fit when its time is over or it is stopped, waits
/// while the robot is busy, writes checkpoints, and continues where an earlier process was.
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
  /// All arguments but `sink` must outlive it.
  FitLoop(FitPhase phase, Schedule& schedule, JobPace& pace, Checkpoints& checkpoints,
          StepSink sink);

  /// Restores the state that an earlier process kept of this phase. If that process was in a later
  /// phase, it restores the weights only, and this phase is over at once.
  /// Errors: kDataLoss if the kept state does not fit; it is refused, and training must start again
  /// from the first phase.
  Status begin(FitState& state);

  /// Returns the share of the time that is over before the next step, which is 1 or more at the
  /// end.
  /// Errors: the errors of JobPace::pause, before which the state is kept.
  Result<double> next(const FitState& state);

  /// Adds a step to the curve of training and passes it to the sink.
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
