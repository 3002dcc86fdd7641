// SPDX-License-Identifier: Apache-2.0
#include "training/night/expected_encoding.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

#include "ltm/codec/group_codec.h"

#include "training/fit/entity_source.h"
#include "training/fit/network_width.h"
#include "training/fit/trainer.h"
#include "training/forms/entity_videos.h"
#include "training/forms/video_effort.h"
#include "training/night/encode_entity.h"
#include "training/night/entity_images.h"

namespace engram::training {

namespace {

/// Number of snapshots on which encoding is measured, and where there is only video.
constexpr size_t kSample = 32, kVideoSample = 8;
/// The sample has two chains, so that two threads have something to do.
constexpr size_t kSampleChains = 2;
/// Max number of snapshots on which predictions are measured in addition to encoding.
constexpr size_t kMaxMeasured = 256;
/// What measuring predictions takes of the time of encoding where there are no networks.
constexpr double kMeasuredVideoShare = 0.15;
/// What reading, decoding, comparing and residuals take beside one encode.
constexpr double kBesideEncoding = 1.2;
/// How much two threads encode in the time of one.
constexpr double kTwoThreads = 1.7;
/// Where nothing is known about how quality follows from crf.
constexpr int kAnyCrf = 28;
/// A snapshot whose video the store holds takes this share of the time.
constexpr double kKnownShare = 0.05;

/// The first snapshots without latents: videos of the others may be known.
std::vector<ltm::SnapshotEntry> sample_of(const PlannedEntity& planned, size_t wanted) {
  std::vector<ltm::SnapshotEntry> sample;
  for (const bool is_known : {false, true})
    for (const ltm::SnapshotEntry& entry : planned.entries)
      if (sample.size() < wanted && entry.latent.has_value() == is_known) sample.push_back(entry);
  std::ranges::sort(sample, {}, &ltm::SnapshotEntry::time);
  return sample;
}

/// The time of a snapshot as video, from a single encode of a few: a search that knows nothing
/// takes as long as a short night has. It is 0 if no codec accepts the images.
Result<double> seconds_as_video(const EntityWork& work, const PlannedEntity& planned,
                                const ChosenForm& form) {
  const auto sample = sample_of(planned, kVideoSample);
  MemberImages images;
  for (const ltm::SnapshotEntry& entry : sample)
    ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entry, images));
  const auto start = std::chrono::steady_clock::now();
  for (size_t i = 0; i < images.size(); ++i) {
    const VideoSearch& search = form.representation.videos->search_of(i);
    const VideoSearchOptions& options = search.options();
    const int crf =
        search.history().is_empty()
            ? kAnyCrf
            : std::clamp(search.history().first_guess(options.bound_db, options.tolerance_db), 1,
                         50);
    const auto codec =
        ltm::make_group_codec(fmt::format("{}:crf={},{}", options.codec, crf, options.settings));
    if (!codec.ok() || !(*codec)->encode(images[i]).ok()) return 0.0;
  }
  const double once = to_seconds(std::chrono::steady_clock::now() - start);
  const bool has_two = form.representation.threads > 1 && std::thread::hardware_concurrency() > 1;
  const double encodes = encodes_of_chain(form.representation.video_tolerance_db);
  return kBesideEncoding * encodes * once / static_cast<double>(sample.size()) /
         (has_two ? kTwoThreads : 1.0);
}

Result<ExpectedEncoding> measure_video(const EntityWork& work, const PlannedEntity& planned,
                                       const ChosenForm& form) {
  ENGRAM_ASSIGN_OR_RETURN(const double each, seconds_as_video(work, planned, form));
  if (each == 0) return ExpectedEncoding();
  const auto news = static_cast<double>(planned.plan.new_snapshots);
  const auto all = static_cast<double>(planned.entries.size());
  const double once = each * (news + (all - news) * kKnownShare);
  const double predictions =
      each * kMeasuredVideoShare * std::min(all, static_cast<double>(kMaxMeasured));
  return ExpectedEncoding{once, with_encoding_margin(once + predictions), each};
}

}  // namespace

double with_encoding_margin(double seconds) {
  constexpr double kFactor = 1.25;
  constexpr double kFixed = 3;  // Writing the model, publishing. Unit: s.
  return kFactor * seconds + kFixed;
}

Result<ExpectedEncoding> measure_encoding(const EntityWork& work, const PlannedEntity& planned,
                                          const ChosenForm& form) {
  const auto stage = work.stage(Stage::kSamples);
  work.pace.progress()({"measure " + work.entity.to_string(), 0, 1, {}, -1});
  const auto& entries = planned.entries;
  if (form.is_video_alone() && planned.has_images_alone())
    return measure_video(work, planned, form);
  const auto sample = sample_of(planned, kSample);
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
      planned.compares_models(work.options) && planned.plan.newest_version > 0;
  const auto news = static_cast<double>(has_previous ? planned.plan.new_snapshots : 0);
  const auto measured = static_cast<double>(std::min(entries.size(), kMaxMeasured));
  return ExpectedEncoding{
      per_snapshot * count,
      with_encoding_margin(per_snapshot * (count * (may_repeat ? 2 : 1) + news + measured)),
      per_snapshot};
}

}  // namespace engram::training
