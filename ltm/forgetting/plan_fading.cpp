// SPDX-License-Identifier: Apache-2.0
//
// The part of ForgetPlanner that lets snapshots fade. It asks the same policies as forgetting does,
// and looks up how good the latents of what they propose are, because what has faded so far already
// would gain nothing.
#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/forgetting/forget_planner.h"

namespace engram::ltm {

namespace {

/// Fading by less would cost more quality than it frees bytes. Unit: dB.
constexpr double kMinFadeDb = 1;
/// How much the logarithm of an image's bytes shrinks with a decibel.
/// Source: experiments/learning/LOG.md, "residuals of videos".
constexpr double kBytesPerDb = 0.25;
/// The part that a gist leaves of an image's bytes, roughly.
constexpr double kGistShare = 0.1;
/// The part of the estimate on which later rounds for a quota rely.
constexpr double kCarefulFading = 0.7;

/// How far one snapshot may still fade.
struct FadingState {
  double certain_db = 0;  ///< PSNR that its worst image certainly has; infinite without loss.
  double faded_to_db = std::numeric_limits<double>::infinity();
  bool has_images = false;
};

double psnr_of(double mse) {
  return 10 * std::log10(255.0 * 255.0 / mse);
}

FadingState state_of(const std::vector<LatentQuality>& qualities) {
  FadingState state;
  state.certain_db = std::numeric_limits<double>::infinity();
  for (const LatentQuality& quality : qualities) {
    const double mse = quality.certain().image_mse;
    if (std::isnan(mse)) continue;
    state.has_images = true;
    state.faded_to_db = std::min(state.faded_to_db, static_cast<double>(quality.faded_to_db));
    state.certain_db = std::min(state.certain_db, psnr_of(mse));
  }
  return state;
}

/// Whether a step gains anything. What is also recorded can always be coded anew.
bool may_fade(const FadingState& state, const FadeStep& step, bool is_recorded) {
  if (!state.has_images) return false;
  // A gist counts as 0 dB in both. A killed job may have left the recorded form of what had faded.
  if (state.faded_to_db <= step.psnr_db.value_or(0)) return is_recorded;
  return is_recorded || !step.psnr_db || state.certain_db >= *step.psnr_db + kMinFadeDb;
}

/// The part of the latents' bytes that a step leaves.
double share_left(const FadingState& state, const FadeStep& step) {
  if (!step.psnr_db) return kGistShare;
  const double lost_db = std::min(state.certain_db, FadeStep::kMaxPsnrDb) - *step.psnr_db;
  return std::clamp(std::exp(-kBytesPerDb * lost_db), kGistShare, 1.0);
}

/// Bytes of a snapshot's entity in a segment, per snapshot.
double bytes_in(const Manifest& manifest, uint32_t segment, const MemoryId& entity) {
  const SegmentEntity* part = manifest.segments[segment].find(entity);
  if (part == nullptr || part->snapshots == 0) return 0;
  return static_cast<double>(part->stored_bytes) / static_cast<double>(part->snapshots);
}

double bytes_freed(const Manifest& manifest, const MemoryId& entity, const SnapshotPlaces& places,
                   double left) {
  const double recorded =
      places.has_recorded_segment() ? bytes_in(manifest, places.recorded, entity) : 0;
  return recorded + (1 - left) * bytes_in(manifest, places.latent, entity);
}

}  // namespace

Status ForgetPlanner::fade(Entity& entity, size_t snapshot, size_t step, uint16_t reason) {
  const SnapshotPlaces& places = entity.places[snapshot];
  Faded& faded = entity.fading[snapshot];
  const bool is_further =
      faded.reason == kStays || steps_[step].is_further_than(steps_[faded.step]);
  // What has no latents waits for consolidation.
  if (!places.has_latents() || !places.is_sealed() || !is_further) return {};
  ENGRAM_ASSIGN_OR_RETURN(const SnapshotEntry found, entry(entity, snapshot));
  ENGRAM_ASSIGN_OR_RETURN(const auto qualities, source_.store().read_qualities(entity.id, found));
  const FadingState state = state_of(qualities);
  if (!may_fade(state, steps_[step], places.has_recorded_segment())) return {};
  const double freed =
      bytes_freed(source_.store().manifest(), entity.id, places, share_left(state, steps_[step]));
  faded_bytes_ += freed - static_cast<double>(faded.bytes);
  faded = {reason, static_cast<uint8_t>(step), static_cast<float>(freed)};
  return {};
}

Status ForgetPlanner::fade_entity(Entity& entity, size_t step) {
  ENGRAM_ASSIGN_OR_RETURN(const uint16_t reason,
                          reason_of(steps_[step].rule, steps_[step].text() + ": "));
  std::vector<size_t> proposed;
  ENGRAM_RETURN_IF_ERROR(ask(steps_[step].rule, entity, {}, [&](const ForgetProposal& proposal) {
    proposed.push_back(proposal.snapshot);
  }));
  for (const size_t snapshot : proposed)
    ENGRAM_RETURN_IF_ERROR(fade(entity, snapshot, step, reason));
  return {};
}

Status ForgetPlanner::fade_by(const ForgetOptions& options) {
  steps_ = options.fade;
  if (steps_.empty()) return {};
  for (Entity& entity : entities_) entity.fading.resize(entity.times.size());
  if (options.is_later_round) return {};
  for (size_t i = 0; i < entities_.size(); ++i) {
    ENGRAM_RETURN_IF_ERROR(check_stop("plan fading", i));
    for (size_t step = 0; step < steps_.size(); ++step)
      if (steps_[step].rule.match.matches(entities_[i].id))
        ENGRAM_RETURN_IF_ERROR(fade_entity(entities_[i], step));
  }
  return {};
}

double ForgetPlanner::counted_faded_bytes(const ForgetOptions& options) const {
  return options.is_later_round ? kCarefulFading * faded_bytes_ : faded_bytes_;
}

Status ForgetPlanner::fade_for_quota(const ForgetOptions& options) {
  const auto wanted = static_cast<double>(wanted_bytes(options));
  const auto going = static_cast<double>(counted_bytes(freed(), options));
  std::vector<std::vector<bool>> is_queued(entities_.size());
  for (size_t step = 0; step < steps_.size() && going + counted_faded_bytes(options) < wanted;
       ++step) {
    // Its policies but the age decide what fades for a quota, the oldest first.
    ForgetRule rule = steps_[step].rule;
    rule.age.emplace();
    for (size_t e = 0; e < entities_.size(); ++e)
      is_queued[e].assign(entities_[e].reason.size(), false);
    ENGRAM_ASSIGN_OR_RETURN(const uint16_t reason,
                            reason_of(rule, "quota, " + steps_[step].text() + ": "));
    ENGRAM_ASSIGN_OR_RETURN(const auto candidates, candidates_of(rule, is_queued));
    const double before = faded_bytes_;
    for (const Candidate& each : candidates) {
      if (going + counted_faded_bytes(options) >= wanted) break;
      ENGRAM_RETURN_IF_ERROR(fade(entities_[each.entity], each.snapshot, step, reason));
    }
    fades_for_quota_ = fades_for_quota_ || faded_bytes_ != before;
  }
  return {};
}

void ForgetPlanner::add_fading(const Entity& entity, EntityForgetPlan& plan) const {
  std::map<uint8_t, TimeSet> by_step;
  double bytes = 0;
  for (size_t i = 0; i < entity.fading.size(); ++i) {
    const Faded& faded = entity.fading[i];
    if (faded.reason == kStays || entity.reason[i] != kStays) continue;
    by_step[faded.step].insert(entity.times[i]);
    ++plan.fading_reasons[reasons_[faded.reason]];
    bytes += static_cast<double>(faded.bytes);
  }
  plan.faded_bytes = static_cast<uint64_t>(bytes);
  for (auto& [step, times] : by_step)
    plan.fading.push_back({steps_[step].psnr_db, std::move(times)});
}

}  // namespace engram::ltm
