// SPDX-License-Identifier: Apache-2.0
#include "training/night/expected_encoding.h"

#include <algorithm>
#include <vector>

#include "training/fit/entity_source.h"
#include "training/fit/network_width.h"
#include "training/fit/trainer.h"
#include "training/forms/entity_videos.h"
#include "training/night/encode_entity.h"

namespace engram::training {

namespace {

/// Number of snapshots on which encoding is measured, and of large images.
constexpr size_t kSample = 32, kLargeSample = 16;
constexpr int64_t kLargePixels = 256 * 256;
/// The sample has two chains, so that two threads have something to do.
constexpr size_t kSampleChains = 2;
/// Max number of snapshots on which predictions are measured in addition to encoding.
constexpr size_t kMaxMeasured = 256;
/// Encodes of a chain with and without a tolerance, once it is known how quality follows from crf.
constexpr double kEncodes = 1.9, kWholeEncodes = 3.2;
/// What measuring predictions takes of the time of encoding where there are no networks.
constexpr double kMeasuredVideoShare = 0.15;
/// A snapshot whose video the store holds takes this share of the time.
constexpr double kKnownShare = 0.05;

/// The first snapshots without latents: videos of the others may be known.
std::vector<ltm::SnapshotEntry> sample_of(const PlannedEntity& planned, const ChosenForm& form) {
  const size_t wanted = form.image_pixels > kLargePixels ? kLargeSample : kSample;
  std::vector<ltm::SnapshotEntry> sample;
  for (const bool is_known : {false, true})
    for (const ltm::SnapshotEntry& entry : planned.entries)
      if (sample.size() < wanted && entry.latent.has_value() == is_known) sample.push_back(entry);
  std::ranges::sort(sample, {}, &ltm::SnapshotEntry::time);
  return sample;
}

/// Time of a snapshot as video once searches begin where others ended. The first ones take more
/// encodes.
double seconds_as_video(double seconds, const EntityCosts& costs, double tolerance_db) {
  double encodes = 0;
  for (const int count : costs.encodes) encodes += count;
  if (encodes == 0) return seconds;
  const double usual = tolerance_db > 0 ? kEncodes : kWholeEncodes;
  return seconds * std::min(1.0, usual * static_cast<double>(costs.encodes.size()) / encodes);
}

}  // namespace

double with_encoding_margin(double seconds) {
  constexpr double kFactor = 1.25;
  constexpr double kFixed = 3;  // Writing the model, publishing. Unit: s.
  return kFactor * seconds + kFixed;
}

Result<ExpectedEncoding> measure_encoding(const EntityWork& work, const PlannedEntity& planned,
                                          ChosenForm& form) {
  const auto stage = work.stage(Stage::kSamples);
  work.pace.progress()({"measure " + work.entity.to_string(), 0, 1, {}, -1});
  const auto& entries = planned.entries;
  const auto sample = sample_of(planned, form);
  TrainOptions quick = form.train;
  quick.chain_rows =
      std::min(quick.chain_rows, std::max(1, static_cast<int>(sample.size() / kSampleChains)));
  quick.steps = 2;
  quick.width = network_width(form.train, entries.size());
  quick.hold_out_recordings = 0;
  const ProgressSink no_progress;
  const auto fitted =
      fit_model(EntitySource::values(work.reader, work.entity, planned.layout, sample), quick,
                no_progress, work.pace.stop());
  if (fitted.status().code() == StatusCode::kInvalidArgument) return ExpectedEncoding();
  ENGRAM_RETURN_IF_ERROR(fitted.status());
  // The sample has a pace of its own, so that waiting for the robot does not count as work.
  JobPace pace(nullptr, no_progress, work.pace.stop());
  EntityCosts costs;  // They all belong to the samples.
  const EntityWork quiet{work.reader, work.entity, work.options, pace, costs};
  // After two steps a model misses every bound by far, so no block would be refined. Later some may
  // be.
  RepresentationOptions slowest = form.representation;
  if (slowest.kind == Representation::kAuto)
    slowest.refine_steps = std::max(slowest.refine_steps, slowest.few_refine_steps);
  // What was found when the form was chosen would be found again in no time.
  if (slowest.videos) slowest.videos = slowest.videos->without_videos();
  const auto encoded = encode_entity(quiet, fitted->model, 1, sample, slowest);
  if (encoded.status().code() == StatusCode::kInvalidArgument) return ExpectedEncoding();
  ENGRAM_RETURN_IF_ERROR(encoded.status());
  if (slowest.videos) {
    form.history.learn(*slowest.videos);
    form.history.teach(*form.representation.videos);
  }
  double per_snapshot = encoded->seconds / static_cast<double>(sample.size());
  if (form.is_video_alone())
    per_snapshot = seconds_as_video(per_snapshot, costs, slowest.video_tolerance_db);
  const auto news = static_cast<double>(planned.plan.new_snapshots);
  const auto known = static_cast<double>(entries.size()) - news;
  const double once = per_snapshot * (news + known * (form.is_video_alone() ? kKnownShare : 1));
  // Everything may have to be encoded again as video alone, and new snapshots with the previous
  // model.
  const bool may_repeat =
      form.representation.kind == Representation::kAuto && form.train.has_networks;
  const bool has_previous = may_repeat && planned.plan.newest_version > 0;
  const double measured = static_cast<double>(std::min(entries.size(), kMaxMeasured)) *
                          (form.is_video_alone() ? kMeasuredVideoShare : 1);
  const double all =
      once * (may_repeat ? 2 : 1) + per_snapshot * ((has_previous ? news : 0) + measured);
  return ExpectedEncoding{once, with_encoding_margin(all), per_snapshot};
}

}  // namespace engram::training
