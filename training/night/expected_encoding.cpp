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

/// Number of snapshots on which encoding is measured.
constexpr size_t kSample = 32;
/// Max number of snapshots on which predictions are measured in addition to encoding.
constexpr size_t kMaxMeasured = 256;

}  // namespace

double with_encoding_margin(double seconds) {
  constexpr double kFactor = 1.25;
  constexpr double kFixed = 3;  // Writing the model, publishing. Unit: s.
  return kFactor * seconds + kFixed;
}

Result<ExpectedEncoding> measure_encoding(const EntityWork& work, const PlannedEntity& planned,
                                          const ChosenForm& form) {
  const auto stage = work.stage(Stage::kSamples);
  const auto& entries = planned.entries;
  const std::vector<ltm::SnapshotEntry> sample(
      entries.begin(), entries.begin() + static_cast<ptrdiff_t>(std::min(kSample, entries.size())));
  TrainOptions quick = form.train;
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
  const double per_snapshot = encoded->seconds / static_cast<double>(sample.size());
  const auto count = static_cast<double>(entries.size());
  // Everything may have to be encoded again as video alone, and new snapshots with the previous
  // model.
  const bool may_repeat =
      form.representation.kind == Representation::kAuto && form.train.has_networks;
  const bool has_previous =
      work.options.representation.kind == Representation::kAuto && planned.plan.newest_version > 0;
  const auto news = static_cast<double>(has_previous ? planned.plan.new_snapshots : 0);
  const auto measured = static_cast<double>(std::min(entries.size(), kMaxMeasured));
  return ExpectedEncoding{
      per_snapshot * count,
      with_encoding_margin(per_snapshot * (count * (may_repeat ? 2 : 1) + news + measured))};
}

}  // namespace engram::training
