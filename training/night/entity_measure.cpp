// SPDX-License-Identifier: Apache-2.0
// What a job on an entity learns from samples before it works: which form, and how long it takes.
#include <algorithm>
#include <chrono>
#include <utility>

#include "encoders/deep_model_file.h"
#include "training/fit/entity_source.h"
#include "training/fit/network_width.h"
#include "training/fit/trainer.h"
#include "training/forms/noise_floor.h"
#include "training/forms/video_search.h"
#include "training/night/entity_encoding.h"
#include "training/night/entity_job.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// What the mean PSNR of latents has to exceed the bound by. Unit: dB.
constexpr double kMargin = 1.0;
/// Snapshots that encoding is measured on.
constexpr size_t kSample = 32;
/// Predictions are measured beside encoding, on so many snapshots at most.
constexpr size_t kMostMeasured = 256;
/// Pairs of consecutive images that noise is measured on.
constexpr size_t kNoisePairs = 32;

}  // namespace

double with_encoding_margin(double seconds) {
  constexpr double kFactor = 1.25;
  constexpr double kFixed = 3;  // Reading the model back, publishing. Unit: s.
  return kFactor * seconds + kFixed;
}

Status EntityJob::choose_bound() {
  const bool has_images = std::ranges::any_of(
      layout_.members(), [](const auto& member) { return member.kind == idf::MemberKind::kImage; });
  if (!has_images) {
    // Of numbers there is one form.
    representation_.kind = Representation::kLatents;
    return {};
  }
  if (representation_.bound_db == 0) {
    NoiseFloor floor;
    const size_t step = std::max<size_t>(1, entries_.size() / kNoisePairs);
    for (size_t i = 0; i + 1 < entries_.size(); i += step) {
      std::vector<std::vector<idf::NdArray>> images;
      for (const size_t at : {i, i + 1})
        ENGRAM_RETURN_IF_ERROR(append_images(entries_[at], images));
      for (const auto& pair : images) ENGRAM_RETURN_IF_ERROR(floor.add(pair[0], pair[1]));
    }
    representation_.noise_images = floor.images();
    representation_.noise = floor.deviation().value_or(0);
    representation_.bound_db = bound_of_noise(representation_.noise);
  }
  if (representation_.kind != Representation::kLatents)
    plan_.bound = {representation_.bound_db, representation_.noise_images, representation_.noise};
  return {};
}

Status EntityJob::choose_form() {
  if (std::exchange(is_form_chosen_, true)) return {};
  ENGRAM_ASSIGN_OR_RETURN(train_.has_networks, wants_networks());
  if (!train_.has_networks) representation_.kind = Representation::kVideo;
  // The mean has to lie above the bound for every image to reach it.
  if (representation_.kind == Representation::kAuto ||
      representation_.kind == Representation::kCorrected)
    train_.psnr_db = std::min(representation_.bound_db + kMargin, kLargestPsnrDb);
  return {};
}

Result<double> EntityJob::measure_encoding() {
  if (!report_.skipped_reason.empty()) return 0.0;
  ENGRAM_RETURN_IF_ERROR(choose_form());
  const std::vector<ltm::SnapshotEntry> sample(
      entries_.begin(),
      entries_.begin() + static_cast<ptrdiff_t>(std::min(kSample, entries_.size())));
  ENGRAM_ASSIGN_OR_RETURN(const auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
  TrainOptions quick = train_;
  quick.steps = 2;
  quick.width = network_width(train_, entries_.size());
  quick.hold_out_recordings = 0;
  const ProgressSink no_progress;
  const auto trained = train_model(EntitySource::values(reader_, entity_, layout_, sample), quick,
                                   file.path(), no_progress, pace_.stop());
  if (trained.status().code() == StatusCode::kInvalidArgument) return 0.0;  // Skipped later.
  ENGRAM_RETURN_IF_ERROR(trained.status());
  ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(file.path()));
  const auto decoder = encoders::make_encoder(model);
  const auto start = std::chrono::steady_clock::now();
  JobPace pace(nullptr, no_progress, pace_.stop());
  // So early a model misses every bound by far: later some blocks may be refined.
  RepresentationOptions slowest = representation_;
  if (slowest.kind == Representation::kAuto)
    slowest.refine_steps = std::max(slowest.refine_steps, slowest.few_refine_steps);
  EntityEncoding encoding(reader_, entity_, 1, *model, *decoder, slowest);
  const Status encoded = encoding.run(sample, pace);
  if (encoded.code() == StatusCode::kInvalidArgument) return 0.0;
  ENGRAM_RETURN_IF_ERROR(encoded);
  const double per_snapshot =
      to_seconds(std::chrono::steady_clock::now() - start) / static_cast<double>(sample.size());
  const auto count = static_cast<double>(entries_.size());
  report_.expected_encoding_seconds = per_snapshot * count;
  // All may have to be coded again, as video alone, and what is new by the model before.
  const bool may_repeat = representation_.kind == Representation::kAuto && train_.has_networks;
  const bool has_previous =
      options_.representation.kind == Representation::kAuto && plan_.newest_version > 0;
  const auto news = static_cast<double>(has_previous ? plan_.new_snapshots : 0);
  const auto measured = static_cast<double>(std::min(entries_.size(), kMostMeasured));
  return with_encoding_margin(per_snapshot * (count * (may_repeat ? 2 : 1) + news + measured));
}

Result<bool> EntityJob::wants_networks() {
  const RepresentationOptions& representation = representation_;
  if (options_.reuses_models) return true;
  if (representation.kind != Representation::kAuto)
    return representation.kind != Representation::kVideo;
  TrainOptions least = train_;
  if (least.width == 0) least.width = 32;
  const uint64_t networks = network_bytes(layout_, least);
  if (networks == 0) return true;
  ENGRAM_ASSIGN_OR_RETURN(const double video, sampled_video_bytes());
  if (video == 0) return true;  // No codec takes its images.
  const double saved = video * static_cast<double>(entries_.size()) * representation.nights;
  if (train_.width == 0) {
    train_.width = width_that_pays(layout_, train_, saved);
    if (train_.width > 0) return true;
  } else if (static_cast<double>(networks) <= kMostModelShare * saved) {
    return true;
  }
  report_.notes.push_back(fmt::format(
      "video at {:.1f} dB takes {:.0f} bytes a snapshot: {:.0f} % of it in {} nights is "
      "less than what networks take ({} bytes)",
      representation.bound_db, video, 100 * kMostModelShare, representation.nights, networks));
  return false;
}

Result<double> EntityJob::sampled_video_bytes() {
  constexpr size_t kRuns = 4;
  const auto most = static_cast<size_t>(options_.train.chain_rows);
  const size_t step = std::max<size_t>(1, entries_.size() / kRuns);
  const auto& representation = representation_;
  double bytes = 0;
  size_t count = 0;
  for (size_t first = 0; first < entries_.size(); first += step) {
    const size_t end = std::min(first + std::min(most, step), entries_.size());
    std::vector<std::vector<idf::NdArray>> images;
    for (size_t i = first; i < end; ++i) ENGRAM_RETURN_IF_ERROR(append_images(entries_[i], images));
    for (const auto& run : images) {
      VideoSearch search(representation.video, representation.video_effort,
                         representation.bound_db);
      ENGRAM_ASSIGN_OR_RETURN(const auto found, search.find(run));
      if (found) bytes += static_cast<double>(found->bytes.size());
    }
    count += end - first;
  }
  return bytes / static_cast<double>(count);
}

Status EntityJob::append_images(const ltm::SnapshotEntry& entry,
                                std::vector<std::vector<idf::NdArray>>& images) {
  ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader_.read_recorded(entity_, entry));
  ENGRAM_ASSIGN_OR_RETURN(auto split, layout_.split(snapshot.instances.front().data));
  size_t at = 0;
  for (size_t member = 0; member < split.tensors.size(); ++member) {
    if (layout_.members()[member].kind != idf::MemberKind::kImage) continue;
    if (images.size() == at) images.emplace_back();
    images[at++].push_back(std::move(split.tensors[member]));
  }
  return {};
}

}  // namespace engram::training
