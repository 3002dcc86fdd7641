// SPDX-License-Identifier: Apache-2.0
#include "training/consolidate.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "encoders/deep_model_file.h"
#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/layout.h"
#include "ltm/memory/query.h"
#include "ltm/store/publish.h"
#include "ltm/store/store_reader.h"
#include "training/block_choice.h"
#include "training/metrics.h"
#include "training/sequences.h"

namespace engram::training {

namespace {

/// What the mean PSNR of latents has to exceed the bound by. Unit: dB.
constexpr double kMargin = 1.0;
/// Networks may take a fifth of what they save.
constexpr double kWorthwhile = 5;

/// Whether every instance has this layout.
bool fits(const ltm::Snapshot& snapshot, const idf::Layout& layout) {
  return !snapshot.instances.empty() &&
         std::all_of(snapshot.instances.begin(), snapshot.instances.end(),
                     [&](const auto& instance) { return layout.split(instance.data).ok(); });
}

/// Offline work on one entity of one generation of a store.
class EntityJob {
 public:
  EntityJob(ltm::StoreReader& reader, ltm::MemoryId entity, const ConsolidateOptions& options,
            const ProgressSink& progress, const std::stop_token& stop)
      : reader_(reader),
        entity_(std::move(entity)),
        options_(options),
        progress_(progress),
        stop_(stop) {
    report_.entity = entity_;
  }

  /// Finds the recorded snapshots, or the reason to skip the entity.
  Status plan() {
    ENGRAM_ASSIGN_OR_RETURN(const auto summary, reader_.summary(entity_));
    report_.stored_bytes = summary.stored_bytes;
    plain_bytes_ = static_cast<double>(summary.raw_bytes);
    ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader_.index(entity_));
    bool has_news = false;
    for (const ltm::SnapshotEntry& entry : *index) {
      // What is not sealed yet is the next night's: it will come after the latents of this one.
      if (!entry.recorded || entry.recorded->rows == 0) continue;
      entries_.push_back(entry);
      has_news = has_news || !entry.latent;
    }
    if (entries_.size() < options_.min_snapshots)
      return skip(
          fmt::format("{} recorded snapshots, needs {}", entries_.size(), options_.min_snapshots));
    if (!has_news && !options_.force) return skip("nothing new");
    return find_layout();
  }

  /// How much of the training time this entity should get, beside others. Larger values need more
  /// of it, but not in proportion.
  [[nodiscard]] double weight() const {
    return report_.skipped_reason.empty() ? std::sqrt(plain_bytes_) : 0;
  }

  /// Trains for `budget` where the entity is not skipped.
  Result<EntityReport> run(Duration budget) {
    const auto start = std::chrono::steady_clock::now();
    if (report_.skipped_reason.empty()) ENGRAM_RETURN_IF_ERROR(train_and_publish(budget));
    report_.seconds = to_seconds(std::chrono::steady_clock::now() - start);
    return std::move(report_);
  }

 private:
  /// The layout of most snapshots would need reading all; the newest one's is what comes next.
  Status find_layout() {
    ENGRAM_ASSIGN_OR_RETURN(const auto newest, reader_.read_recorded(entity_, entries_.back()));
    if (newest.instances.empty()) return skip("the newest snapshot has no instance");
    layout_ = idf::Layout::of(newest.instances.front().data);
    std::vector<ltm::SnapshotEntry> fitting;
    for (const ltm::SnapshotEntry& entry : entries_) {
      if (stop_.stop_requested()) return cancelled("consolidation was stopped");
      ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, reader_.read_recorded(entity_, entry));
      if (fits(snapshot, layout_))
        fitting.push_back(entry);
      else
        ++report_.left_behind;
    }
    entries_ = std::move(fitting);
    if (entries_.size() < options_.min_snapshots)
      return skip(fmt::format("{} recorded snapshots of the newest layout, needs {}",
                              entries_.size(), options_.min_snapshots));
    return {};
  }

  Status skip(std::string reason) {
    report_.skipped_reason = std::move(reason);
    return {};
  }

  Status train_and_publish(Duration budget) {
    TrainOptions train = options_.train;
    train.budget = budget;
    RepresentationOptions representation = options_.representation;
    ENGRAM_ASSIGN_OR_RETURN(train.has_networks, wants_networks(train));
    if (!train.has_networks) representation.kind = Representation::kVideo;
    // The mean has to lie above the bound for every image to reach it.
    if (representation.kind == Representation::kAuto)
      train.psnr_db = representation.bound_db + kMargin;
    ENGRAM_ASSIGN_OR_RETURN(bool is_made, make(train, representation));
    if (is_made && representation.kind == Representation::kAuto && video_is_cheaper()) {
      train.has_networks = false;
      representation.kind = Representation::kVideo;
      ENGRAM_ASSIGN_OR_RETURN(is_made, make(train, representation));
    }
    if (!is_made) return {};
    ENGRAM_RETURN_IF_ERROR(ltm::publish_model(reader_.path(), entity_, report_.model_version,
                                              file_->path(), latents_,
                                              reader_.manifest().first_journal));
    finish();
    return {};
  }

  /// Trains a model and codes all snapshots with it. False where it has to be skipped.
  Result<bool> make(const TrainOptions& train, const RepresentationOptions& representation) {
    ENGRAM_ASSIGN_OR_RETURN(const auto trained_file,
                            ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
    auto trained = train_model(source(), train, trained_file.path(), progress_, stop_);
    // What cannot be a tensor stays recorded; everything else can go on.
    if (!trained.ok() && trained.status().code() == StatusCode::kInvalidArgument) {
      ENGRAM_RETURN_IF_ERROR(skip(trained.status().message()));
      return false;
    }
    if (!trained.ok()) return trained.status();
    report_.training = std::move(*trained);
    report_.model_version = ltm::next_model_version(reader_.manifest(), entity_);
    start_counting();
    ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(trained_file.path()));
    BlockChoice choice(*model, representation);
    ENGRAM_RETURN_IF_ERROR(encode_all(choice, *encoders::make_encoder(model)));
    model->provenance.forms = report_.forms = choice.counts();
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Snapshot example,
                            reader_.read_recorded(entity_, entries_.front()));
    ENGRAM_ASSIGN_OR_RETURN(auto file, ltm::TemporaryFile::create(reader_.path(), ".model.h5"));
    ENGRAM_RETURN_IF_ERROR(
        encoders::save_model(*model, example.instances.front().data, file.path()));
    file_.emplace(std::move(file));
    std::error_code failed;
    report_.model_bytes = std::filesystem::file_size(file_->path(), failed);
    if (failed) return unavailable("model '{}': {}", file_->path().string(), failed.message());
    return true;
  }

  void start_counting() {
    latents_.clear();
    psnr_ = {};
    rmse_ = {};
    report_.raw_bytes = report_.latent_bytes = 0;
  }

  /// Whether networks for images could save five times their bytes, if they took none at all.
  Result<bool> wants_networks(const TrainOptions& train) {
    const RepresentationOptions& representation = options_.representation;
    if (representation.kind != Representation::kAuto)
      return representation.kind == Representation::kLatents;
    const uint64_t networks = network_bytes(layout_, train, entries_.size());
    if (networks == 0) return true;
    ENGRAM_ASSIGN_OR_RETURN(const double video, sampled_video_bytes());
    const double saved = video * static_cast<double>(entries_.size()) * representation.nights;
    if (saved >= kWorthwhile * static_cast<double>(networks)) return true;
    report_.notes.push_back(
        fmt::format("video at {} dB takes {:.0f} bytes a snapshot: {} nights of it are less than {} "
                    "times what networks take ({} bytes)",
                    representation.bound_db, video, representation.nights, kWorthwhile, networks));
    return false;
  }

  [[nodiscard]] bool video_is_cheaper() {
    const auto& forms = report_.forms;
    const double nights = options_.representation.nights;
    const double with_networks = static_cast<double>(forms.kept_bytes) * nights +
                                 static_cast<double>(report_.model_bytes);
    const double video = static_cast<double>(forms.video_bytes) * nights;
    if (forms.video_bytes == 0 || with_networks <= video) return false;
    report_.notes.push_back(fmt::format(
        "networks and the cheaper of latents and video take {:.0f} bytes in {} nights, video alone "
        "{:.0f}",
        with_networks, options_.representation.nights, video));
    return true;
  }

  /// Bytes of a snapshot's images as video at the bound, from some evenly spaced runs.
  Result<double> sampled_video_bytes() {
    constexpr size_t kRuns = 4;
    const auto most = static_cast<size_t>(options_.train.block_rows);
    const size_t step = std::max<size_t>(1, entries_.size() / kRuns);
    const auto& representation = options_.representation;
    double bytes = 0;
    size_t count = 0;
    for (size_t first = 0; first < entries_.size(); first += step) {
      const size_t end = std::min(first + std::min(most, step), entries_.size());
      std::vector<std::vector<idf::NdArray>> images;
      for (size_t i = first; i < end; ++i)
        ENGRAM_RETURN_IF_ERROR(append_images(entries_[i], images));
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

  /// Adds the images of a snapshot's first instance, one per image member.
  Status append_images(const ltm::SnapshotEntry& entry,
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

  TrainingSource source() {
    TrainingSource source;
    source.entity = entity_.to_string();
    for (const ltm::SnapshotEntry& entry : entries_) source.times.push_back(entry.time);
    source.read = [this](size_t i) -> Result<idf::Data> {
      ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot, reader_.read_recorded(entity_, entries_[i]));
      return std::move(snapshot.instances.front().data);
    };
    return source;
  }

  /// Blocks of latents never cross a gap between recordings.
  Status encode_all(BlockChoice& choice, ltm::Encoder& decoder) {
    std::vector<Time> times;
    for (const ltm::SnapshotEntry& entry : entries_) times.push_back(entry.time);
    const auto most = static_cast<size_t>(options_.train.block_rows);
    for (const Sequence& sequence : cut_sequences(times))
      for (size_t first = sequence.first; first < sequence.end; first += most) {
        if (stop_.stop_requested()) return cancelled("consolidation was stopped");
        const size_t count = std::min(most, sequence.end - first);
        ENGRAM_RETURN_IF_ERROR(encode_run(choice, decoder, std::span(entries_).subspan(first, count)));
        if (progress_)
          progress_({"encode " + entity_.to_string(), first + count, entries_.size(), {}, -1});
      }
    return {};
  }

  /// Encodes consecutive snapshots, and compares what a query will see with what was recorded.
  Status encode_run(BlockChoice& choice, ltm::Encoder& decoder,
                    std::span<const ltm::SnapshotEntry> entries) {
    std::vector<idf::Data> values;
    std::vector<ltm::Snapshot> snapshots;
    for (const ltm::SnapshotEntry& entry : entries) {
      ENGRAM_ASSIGN_OR_RETURN(snapshots.emplace_back(), reader_.read_recorded(entity_, entry));
      for (const ltm::Instance& instance : snapshots.back().instances)
        values.push_back(instance.data);
    }
    ENGRAM_ASSIGN_OR_RETURN(auto latents, choice.encode(values));
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded, decoder.decode(latents));
    size_t at = 0;
    for (const ltm::Snapshot& snapshot : snapshots) {
      ltm::LatentSnapshot coded{snapshot.time, report_.model_version, {}};
      for (const ltm::Instance& instance : snapshot.instances) {
        ENGRAM_ASSIGN_OR_RETURN(const auto error, compare(instance.data, decoded[at]));
        count(latents[at], error);
        coded.instances.push_back({std::move(latents[at++]), instance.metadata, error});
      }
      report_.raw_bytes += snapshot.raw_bytes();
      latents_.push_back(std::move(coded));
    }
    return {};
  }

  void count(const ltm::Latent& latent, const ltm::MeasuredError& error) {
    psnr_.add(error.image_mse);
    rmse_.add(error.number_mse);
    if (latent.place.index == 0) report_.latent_bytes += latent.code.size();
    if (!latent.remainder.empty())
      report_.latent_bytes += idf::encoded_size(idf::Data(latent.remainder));
  }

  void finish() {
    report_.snapshots = latents_.size();
    report_.mean_psnr_db = psnr_.mean_db();
    report_.pooled_psnr_db = psnr_.pooled_db();
    report_.minimum_psnr_db = psnr_.minimum_db();
    report_.rmse = rmse_.rmse();
  }

  ltm::StoreReader& reader_;
  ltm::MemoryId entity_;
  const ConsolidateOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  idf::Layout layout_;
  double plain_bytes_ = 0;
  std::vector<ltm::SnapshotEntry> entries_;
  std::vector<ltm::LatentSnapshot> latents_;
  PsnrStatistics psnr_;
  RmseStatistics rmse_;
  std::optional<ltm::TemporaryFile> file_;  ///< The model that will be published.
  EntityReport report_;
};

Result<std::vector<ltm::MemoryId>> matching(const ltm::StoreReader& reader,
                                            const std::vector<std::string>& texts) {
  std::vector<ltm::Query> queries;
  for (const std::string& text : texts) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Query query, ltm::Query::parse(text));
    queries.push_back(std::move(query));
  }
  std::vector<ltm::MemoryId> entities;
  for (const ltm::MemoryId& entity : reader.entities())
    if (queries.empty() || std::any_of(queries.begin(), queries.end(),
                                       [&](const auto& query) { return query.matches(entity); }))
      entities.push_back(entity);
  if (entities.empty())
    return not_found("store '{}': none of its {} entities matches", reader.path().string(),
                     reader.entities().size());
  return entities;
}

}  // namespace

Status ConsolidateOptions::validate() const {
  if (min_snapshots < 2)
    return invalid_argument("smallest number of snapshots: found {}, needs 2", min_snapshots);
  ENGRAM_RETURN_IF_ERROR(representation.validate());
  return train.validate();
}

Result<ConsolidateReport> consolidate(const std::filesystem::path& store,
                                      const ConsolidateOptions& options,
                                      const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store));
  ENGRAM_ASSIGN_OR_RETURN(const auto entities, matching(*reader, options.entities));
  std::vector<EntityJob> jobs;
  double total_weight = 0;
  for (const ltm::MemoryId& entity : entities) {
    EntityJob& job = jobs.emplace_back(*reader, entity, options, progress, stop);
    ENGRAM_RETURN_IF_ERROR(job.plan());
    total_weight += job.weight();
  }
  ConsolidateReport report;
  for (EntityJob& job : jobs) {
    const double share = total_weight > 0 ? job.weight() / total_weight : 0;
    ENGRAM_ASSIGN_OR_RETURN(const Duration budget,
                            duration_from_seconds(to_seconds(options.train.budget) * share));
    ENGRAM_ASSIGN_OR_RETURN(EntityReport one, job.run(budget));
    report.entities.push_back(std::move(one));
  }
  return report;
}

}  // namespace engram::training
