// SPDX-License-Identifier: Apache-2.0
#include "training/entity_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"
#include "training/entity_encoding.h"
#include "training/condition_source.h"
#include "training/entity_source.h"

namespace engram::training {

namespace {

/// What the mean PSNR of latents has to exceed the bound by. Unit: dB.
constexpr double kMargin = 1.0;
/// Networks may take a fifth of what they save.
constexpr double kWorthwhile = 5;
/// A second model, without networks for images, gets this part of the time again.
constexpr int kSecondShare = 10;

}  // namespace

EntityJob::EntityJob(ltm::StoreReader& reader, ltm::MemoryId entity,
                     const ConsolidateOptions& options, const ProgressSink& progress,
                     const std::stop_token& stop)
    : reader_(reader),
      entity_(std::move(entity)),
      options_(options),
      progress_(progress),
      stop_(stop) {
  report_.entity = entity_;
}

Status EntityJob::plan() {
  ENGRAM_ASSIGN_OR_RETURN(const auto summary, reader_.summary(entity_));
  report_.stored_bytes = summary.stored_bytes;
  plain_bytes_ = static_cast<double>(summary.raw_bytes);
  ENGRAM_ASSIGN_OR_RETURN(
      EntitySource found,
      EntitySource::find(reader_, entity_, options_.min_snapshots, !options_.force, stop_));
  report_.left_behind = found.left_behind;
  entries_ = std::move(found.entries);
  layout_ = std::move(found.layout);
  if (!found.missing.empty()) return skip(std::move(found.missing));
  return {};
}

double EntityJob::weight() const {
  return report_.skipped_reason.empty() ? std::sqrt(plain_bytes_) : 0;
}

Result<EntityReport> EntityJob::run(Duration budget) {
  const auto start = std::chrono::steady_clock::now();
  if (report_.skipped_reason.empty()) ENGRAM_RETURN_IF_ERROR(train_and_publish(budget));
  report_.seconds = to_seconds(std::chrono::steady_clock::now() - start);
  return std::move(report_);
}

Status EntityJob::skip(std::string reason) {
  report_.skipped_reason = std::move(reason);
  return {};
}

Status EntityJob::train_and_publish(Duration budget) {
  TrainOptions train = options_.train;
  train.budget = budget;
  RepresentationOptions representation = options_.representation;
  ENGRAM_ASSIGN_OR_RETURN(train.has_networks, wants_networks(train));
  if (!train.has_networks) representation.kind = Representation::kVideo;
  // The mean has to lie above the bound for every image to reach it.
  if (representation.kind == Representation::kAuto)
    train.psnr_db = representation.bound_db + kMargin;
  ENGRAM_ASSIGN_OR_RETURN(bool is_made, make(train, representation));
  if (is_made && representation.kind == Representation::kAuto && !options_.reuses_models &&
      video_is_cheaper()) {
    train.has_networks = false;
    train.budget = budget / kSecondShare;  // Numbers alone.
    representation.kind = Representation::kVideo;
    ENGRAM_ASSIGN_OR_RETURN(is_made, make(train, representation));
  }
  if (!is_made) return {};
  ENGRAM_RETURN_IF_ERROR(ltm::publish_model(reader_.path(), entity_, report_.model_version,
                                            file_->path(), latents_,
                                            reader_.manifest().first_journal));
  return {};
}

Status EntityJob::train(const TrainOptions& train, const std::filesystem::path& file) {
  TrainingSource source = EntitySource::values(reader_, entity_, entries_);
  // The newest one: links of the first may lead to what was forgotten.
  ENGRAM_RETURN_IF_ERROR(ConditionSource::add(reader_, entity_, entries_.back(), source));
  ENGRAM_ASSIGN_OR_RETURN(report_.training, train_model(source, train, file, progress_, stop_));
  return {};
}

Result<std::shared_ptr<encoders::DeepModel>> EntityJob::newest_model() {
  const ltm::ModelInfo* newest = nullptr;
  for (const ltm::ModelInfo& model : reader_.manifest().models)
    if (model.entity == entity_ && (newest == nullptr || model.version > newest->version))
      newest = &model;
  if (newest == nullptr) return not_found("{}: has no model yet", entity_.to_string());
  return encoders::read_model(reader_.path() / newest->file);
}

Result<std::shared_ptr<encoders::DeepModel>> EntityJob::model_for(const TrainOptions& options) {
  if (options_.reuses_models) return newest_model();
  ENGRAM_ASSIGN_OR_RETURN(const auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(train(options, file.path()));
  return encoders::read_model(file.path());
}

Result<bool> EntityJob::make(const TrainOptions& train,
                             const RepresentationOptions& representation) {
  auto made = model_for(train);
  // What cannot be a tensor stays recorded; everything else can go on.
  const bool is_unfit = made.status().code() == StatusCode::kInvalidArgument ||
                        (options_.reuses_models && made.status().code() == StatusCode::kNotFound);
  if (!made.ok() && is_unfit) {
    ENGRAM_RETURN_IF_ERROR(skip(made.status().message()));
    return false;
  }
  if (!made.ok()) return made.status();
  const std::shared_ptr<encoders::DeepModel> model = *std::move(made);
  report_.model_version = ltm::next_model_version(reader_.manifest(), entity_);
  const auto decoder = encoders::make_encoder(model);
  EntityEncoding encoding(reader_, entity_, report_.model_version, *model, *decoder,
                          representation);
  const Status encoded = encoding.run(entries_, progress_, stop_);
  if (encoded.code() == StatusCode::kInvalidArgument) {  // No codec takes its images.
    ENGRAM_RETURN_IF_ERROR(skip(encoded.message()));
    return false;
  }
  ENGRAM_RETURN_IF_ERROR(encoded);
  encoding.report(report_);
  latents_ = std::move(encoding.latents());
  model->provenance.forms = report_.forms;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot example,
                          reader_.read_recorded(entity_, entries_.front()));
  ENGRAM_ASSIGN_OR_RETURN(auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(encoders::save_model(*model, example.instances.front().data, file.path()));
  file_.emplace(std::move(file));
  std::error_code failed;
  report_.model_bytes = std::filesystem::file_size(file_->path(), failed);
  if (failed) return unavailable("model '{}': {}", file_->path().string(), failed.message());
  return true;
}

Result<bool> EntityJob::wants_networks(const TrainOptions& train) {
  const RepresentationOptions& representation = options_.representation;
  if (options_.reuses_models) return true;
  if (representation.kind != Representation::kAuto)
    return representation.kind == Representation::kLatents;
  const uint64_t networks = network_bytes(layout_, train, entries_.size());
  if (networks == 0) return true;
  ENGRAM_ASSIGN_OR_RETURN(const double video, sampled_video_bytes());
  if (video == 0) return true;  // No codec takes its images.
  const double saved = video * static_cast<double>(entries_.size()) * representation.nights;
  if (saved >= kWorthwhile * static_cast<double>(networks)) return true;
  report_.notes.push_back(
      fmt::format("video at {} dB takes {:.0f} bytes a snapshot: {} nights of it are less than {} "
                  "times what networks take ({} bytes)",
                  representation.bound_db, video, representation.nights, kWorthwhile, networks));
  return false;
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

Result<double> EntityJob::sampled_video_bytes() {
  constexpr size_t kRuns = 4;
  const auto most = static_cast<size_t>(options_.train.block_rows);
  const size_t step = std::max<size_t>(1, entries_.size() / kRuns);
  const auto& representation = options_.representation;
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
