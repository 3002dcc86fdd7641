// SPDX-License-Identifier: Apache-2.0
#include "training/fit/fit_loop.h"

#include <algorithm>

#include "ltm/core/free_memory.h"
#include "ltm/core/log.h"

namespace engram::training {

namespace {

/// Much more than a step of small images needs: they would pay for each page that is given back.
constexpr size_t kMaxFreeBytes = size_t{192} << 20;

}  // namespace

FitLoop::FitLoop(FitPhase phase, Schedule& schedule, JobPace& pace, Checkpoints& checkpoints,
                 StepSink sink)
    : phase_(phase),
      schedule_(schedule),
      pace_(pace),
      checkpoints_(checkpoints),
      sink_(std::move(sink)) {}

Status FitLoop::begin(FitState& state) {
  const Checkpoint* found = checkpoints_.found();
  if (found == nullptr || found->phase < phase_) return {};
  is_over_ = found->phase > phase_;
  const Status restored =
      is_over_ ? restore_weights(found->state, state.model) : restore_state(found->state, state);
  if (!restored.ok()) {
    checkpoints_.refuse_found(restored);
    return restored;
  }
  if (is_over_) {
    state.now = phase_ == FitPhase::kAutoencoder ? found->coded : found->predicted;
    return {};
  }
  schedule_.go_on_from(found->share);
  log::info("training goes on from a checkpoint: {} steps, {:.0f} % of the {} phase",
            state.now.step, 100 * found->share, name_of(phase_));
  return {};
}

Result<double> FitLoop::next(const FitState& state) {
  if (is_over_) return 1.0;
  // Tensors of each step come and go among those that stay.
  give_back_memory_above(kMaxFreeBytes);
  const double share = schedule_.share(state.now.step);
  ENGRAM_RETURN_IF_ERROR(pause(state, share));
  if (share >= 1.0 || checkpoints_.is_due()) keep(state, share);
  return share;
}

void FitLoop::tell(const FitStep& now) const {
  checkpoints_.curve.add({static_cast<int32_t>(phase_), now.step,
                          static_cast<float>(checkpoints_.seconds()), static_cast<float>(now.loss),
                          static_cast<float>(now.psnr_db), static_cast<float>(now.bytes)});
  sink_(now);
}

Status FitLoop::pause(const FitState& state, double share) {
  const bool is_stopped = pace_.stop().stop_requested();
  const bool is_busy = !is_stopped && pace_.is_busy();
  if (!is_stopped && !is_busy) return {};
  // The state is kept first, because the robot may be switched off during the wait.
  keep(state, share);
  const double before = pace_.paused_seconds();
  ENGRAM_RETURN_IF_ERROR(pace_.pause());
  checkpoints_.did_not_work(pace_.paused_seconds() - before);
  if (is_busy) schedule_.go_on_from(share);
  return {};
}

void FitLoop::keep(const FitState& state, double share) {
  if (!checkpoints_.is_on()) return;
  checkpoints_.save({phase_, std::min(share, 1.0), 0, {}, {}, kept_state(state), {}});
}

}  // namespace engram::training
