// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/core/log.h"
#include "ltm/store/checkpoint_file.h"
#include "ltm/store/publish.h"
#include "training/fit/augmented_source.h"
#include "training/fit/checkpoint.h"
#include "training/fit/condition_source.h"
#include "training/fit/entity_source.h"
#include "training/fit/trainer.h"
#include "training/night/entity_encoding.h"

namespace engram::training {

namespace {

/// A second model, without networks for images, gets this part of the time again.
constexpr int kSecondShare = 10;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return to_seconds(std::chrono::steady_clock::now() - start);
}

}  // namespace

EntityJob::EntityJob(ltm::StoreReader& reader, ltm::MemoryId entity,
                     const ConsolidateOptions& options, JobPace& pace)
    : reader_(reader),
      entity_(std::move(entity)),
      options_(options),
      pace_(pace),
      train_(options.train),
      representation_(options.representation) {
  report_.entity = plan_.entity = entity_;
}

Status EntityJob::plan() {
  ENGRAM_ASSIGN_OR_RETURN(const auto summary, reader_.summary(entity_));
  report_.stored_bytes = plan_.stored_bytes = summary.stored_bytes;
  describe_newest_model(reader_.manifest(), plan_);
  plain_bytes_ = static_cast<double>(summary.raw_bytes);
  ENGRAM_ASSIGN_OR_RETURN(
      EntitySource found,
      EntitySource::find(reader_, entity_, options_.min_snapshots, !options_.force, pace_.stop()));
  report_.left_behind = found.left_behind;
  plan_.snapshots = found.entries.size();
  plan_.new_snapshots = found.new_snapshots;
  plan_.plain_bytes = found.plain_bytes;
  entries_ = std::move(found.entries);
  layout_ = std::move(found.layout);
  plan_.skipped_reason = found.missing;
  if (!found.missing.empty()) return skip(std::move(found.missing));
  return choose_bound();
}

double EntityJob::weight() const {
  return report_.skipped_reason.empty() ? std::sqrt(plain_bytes_) : 0;
}

Result<EntityReport> EntityJob::run(const Allotment& time) {
  const auto start = std::chrono::steady_clock::now();
  if (report_.skipped_reason.empty()) ENGRAM_RETURN_IF_ERROR(train_and_publish(time));
  // What could not go on for want of time goes on next time.
  if (!is_late_) remove_stale_checkpoints(true);
  report_.seconds = seconds_since(start);
  return std::move(report_);
}

Status EntityJob::skip(std::string reason) {
  report_.skipped_reason = std::move(reason);
  return {};
}

Status EntityJob::skip_for_want_of_time(std::string reason) {
  is_late_ = true;
  return skip(std::move(reason));
}

Status EntityJob::train_and_publish(const Allotment& time) {
  if (options_.reuses_models) return encode_with_newest();
  ENGRAM_RETURN_IF_ERROR(choose_form());
  ENGRAM_RETURN_IF_ERROR(find_augmented_values());
  remove_stale_checkpoints(options_.job.is_fresh);
  ENGRAM_ASSIGN_OR_RETURN(bool is_made, make(train_, time));
  if (is_made && representation_.kind == Representation::kAuto && video_is_cheaper()) {
    if (const auto second = second_allotment(time)) {
      TrainOptions numbers_alone = train_;
      numbers_alone.has_networks = false;
      representation_.kind = Representation::kVideo;
      ENGRAM_ASSIGN_OR_RETURN(is_made, make(numbers_alone, *second));
      if (is_late_) {  // What was made first is good as well, only larger.
        is_made = true;
        is_late_ = false;
        report_.skipped_reason.clear();
      }
    }
  }
  if (!is_made) return {};
  ENGRAM_ASSIGN_OR_RETURN(const bool is_previous_better, goes_on_with_previous());
  if (!report_.skipped_reason.empty()) return {};
  const uint64_t first_unseen = reader_.manifest().first_journal;
  if (!is_previous_better)
    return ltm::publish_model(reader_.path(), entity_, report_.model_version, file_->path(),
                              latents_, first_unseen);
  if (latents_.empty()) return {};
  return ltm::publish_latents(reader_.path(), entity_, report_.model_version, latents_,
                              first_unseen);
}

std::optional<Allotment> EntityJob::second_allotment(const Allotment& first) const {
  Allotment second{first.budget / kSecondShare, std::nullopt, first.encoded_end};
  if (!first.end) return second;
  const double left = to_seconds(*first.encoded_end - system_now()) -
                      with_encoding_margin(report_.encoding_seconds);
  second.budget = std::min(
      second.budget, std::chrono::duration_cast<Duration>(std::chrono::duration<double>(left)));
  if (second.budget <= Duration::zero()) return std::nullopt;
  second.end = system_now() + second.budget;
  return second;
}

TrainingSource EntityJob::source() {
  TrainingSource source = EntitySource::values(reader_, entity_, layout_, entries_);
  source.augmented = augmented_;
  const ltm::ModelInfo* newest = reader_.manifest().newest_model(entity_);
  if (newest == nullptr || options_.starts_anew) return source;
  source.previous = {reader_.path() / newest->file, newest->version, newest->checksum};
  for (const ltm::SnapshotEntry& entry : entries_)
    source.is_known.push_back(version_of(entry) == newest->version);
  return source;
}

Status EntityJob::find_augmented_values() {
  if (options_.augmented.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(augmented_,
                          find_augmented(options_.augmented, entity_, source(), pace_.stop()));
  if (augmented_->origins.empty() && augmented_->left_out == 0) augmented_.reset();
  return {};
}

Status EntityJob::train(const TrainOptions& options, const Allotment& time,
                        const std::filesystem::path& file) {
  TrainOptions train = options;
  train.budget = time.budget;
  TrainControl control{.end = time.end,
                       .checkpoint = checkpoint_of(options),
                       .checkpoint_interval = options_.job.checkpoint_interval,
                       .pace = &pace_};
  TrainingSource values = source();
  // The newest one: links of the first may lead to what was forgotten.
  ENGRAM_RETURN_IF_ERROR(add_condition(reader_, entity_, entries_.back(), values));
  ENGRAM_ASSIGN_OR_RETURN(
      report_.training, train_model(values, train, file, pace_.progress(), pace_.stop(), control));
  return {};
}

std::filesystem::path EntityJob::checkpoint_of(const TrainOptions& train) {
  if (options_.job.checkpoint_interval == Duration::zero()) return {};
  // What the other variants keep beside the model is not in a checkpoint.
  if (train.variant != encoders::TrainingVariant::kRateAware) return {};
  return ltm::checkpoint_file(reader_.path(), entity_, checkpoint_key(source(), train));
}

void EntityJob::remove_stale_checkpoints(bool are_all_stale) {
  std::vector<std::filesystem::path> kept;
  if (!are_all_stale) {
    TrainOptions numbers_alone = train_;
    numbers_alone.has_networks = false;
    kept = {checkpoint_of(train_), checkpoint_of(numbers_alone)};
  }
  if (const Status removed = ltm::remove_checkpoints(reader_.path(), entity_, kept); !removed.ok())
    log::warning("a stale checkpoint stays: {}", removed.message());
}

Result<std::shared_ptr<encoders::DeepModel>> EntityJob::train_new(const TrainOptions& options,
                                                                  const Allotment& time) {
  ENGRAM_ASSIGN_OR_RETURN(const auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(train(options, time, file.path()));
  return encoders::read_model(file.path());
}

Result<bool> EntityJob::goes_on_after(const Status& status) {
  if (status.ok()) return true;
  if (pace_.is_time_over()) {
    ENGRAM_RETURN_IF_ERROR(skip_for_want_of_time(status.message()));
    return false;
  }
  // What cannot be a tensor, or has images that no codec takes, stays recorded; everything else can
  // go on.
  if (status.code() != StatusCode::kInvalidArgument) return status;
  ENGRAM_RETURN_IF_ERROR(skip(status.message()));
  return false;
}

Result<std::vector<ltm::LatentSnapshot>> EntityJob::encode(
    const std::shared_ptr<encoders::DeepModel>& model, int version,
    std::span<const ltm::SnapshotEntry> entries, const RepresentationOptions& representation,
    EntityReport& report) {
  const auto decoder = encoders::make_encoder(model);
  EntityEncoding encoding(reader_, entity_, version, *model, *decoder, representation);
  const auto start = std::chrono::steady_clock::now();
  const Status encoded = encoding.run(entries, pace_);
  report_.encoding_seconds += seconds_since(start);
  ENGRAM_RETURN_IF_ERROR(encoded);
  encoding.report(report);
  return std::move(encoding.latents());
}

Result<bool> EntityJob::make(const TrainOptions& train, const Allotment& time) {
  auto trained = train_new(train, time);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_trained, goes_on_after(trained.status()));
  if (!is_trained) return false;
  const int version = ltm::next_model_version(reader_.manifest(), entity_);
  auto latents = encode(*trained, version, entries_, representation_, report_);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_encoded, goes_on_after(latents.status()));
  if (!is_encoded) return false;
  report_.model_version = version;
  report_.is_model_new = true;
  latents_ = *std::move(latents);
  model_ = *std::move(trained);
  ENGRAM_RETURN_IF_ERROR(save());
  return true;
}

Status EntityJob::save() {
  model_->provenance.forms = report_.forms;
  model_->provenance.choice = report_.choice;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot example,
                          reader_.read_recorded(entity_, entries_.front()));
  ENGRAM_ASSIGN_OR_RETURN(auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(
      encoders::save_model(*model_, example.instances.front().data, file.path()));
  file_.emplace(std::move(file));
  std::error_code failed;
  report_.model_bytes = std::filesystem::file_size(file_->path(), failed);
  if (failed) return unavailable("model '{}': {}", file_->path().string(), failed.message());
  return {};
}

bool EntityJob::video_is_cheaper() {
  const auto& forms = report_.forms;
  const double nights = options_.representation.nights;
  const double with_networks =
      static_cast<double>(forms.kept_bytes) * nights + static_cast<double>(report_.model_bytes);
  const double video = static_cast<double>(forms.video_bytes) * nights;
  if (forms.video_bytes == 0 || with_networks <= video) return false;
  report_.notes.push_back(fmt::format(
      "networks and the cheaper of latents and video take {:.0f} bytes in {} nights, video alone "
      "{:.0f}",
      with_networks, options_.representation.nights, video));
  return true;
}

}  // namespace engram::training
