// SPDX-License-Identifier: Apache-2.0
#include "training/fade/erase_entity.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"
#include "ltm/store/superseded.h"
#include "ltm/store/temporary_file.h"
#include "training/fade/clean_model.h"
#include "training/fade/fade_error.h"
#include "training/fade/gist_ghosts.h"
#include "training/quality/psnr.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

/// What coding anew adds at most to the squared error of an image: a decibel of it.
constexpr double kErrorShare = 0.25;
/// Better than this is no use: a grey level of error in one of ten pixels.
constexpr double kMaxPsnrDb = 58;

bool is_gist(const FadingGroup& group) {
  return group.latents.front().instances.front().quality.faded_to_db == ltm::LatentQuality::kGist;
}

bool is_recorded(const ltm::SnapshotEntry& entry) {
  return entry.recorded && entry.recorded->rows > 0;
}

/// The error that coding a group anew may have in every image.
double max_step_mse(const FadingGroup& group) {
  double mse = mse_of_psnr(0);
  for (const ltm::LatentSnapshot& snapshot : group.latents)
    for (const ltm::LatentInstance& instance : snapshot.instances)
      if (!std::isnan(instance.quality.error.image_mse))
        mse = std::min(mse, instance.quality.error.image_mse);
  return std::max(mse * kErrorShare, mse_of_psnr(kMaxPsnrDb));
}

std::vector<ltm::Latent> codes_of(const FadingGroup& group) {
  std::vector<ltm::Latent> codes;
  for (const ltm::LatentSnapshot& snapshot : group.latents)
    for (const ltm::LatentInstance& instance : snapshot.instances) codes.push_back(instance.latent);
  return codes;
}

}  // namespace

EntityErasing::EntityErasing(const std::filesystem::path& store, const ltm::MemoryId& entity,
                             const ltm::ForgetSet& gone, const ProgressSink& progress,
                             const std::stop_token& stop)
    : store_(store), entity_(entity), gone_(gone), progress_(progress), stop_(stop) {}

bool EntityErasing::goes(Time time) const {
  const auto times = gone_.find(entity_);
  return times != gone_.end() && times->second.contains(time);
}

void EntityErasing::tell() const {
  if (progress_) progress_({"erase " + entity_.to_string(), done_, all_, "", -1});
}

Result<bool> EntityErasing::open() {
  ENGRAM_ASSIGN_OR_RETURN(reader_, ltm::StoreReader::open(store_));
  if (!reader_->has(entity_)) return false;
  const bool loses = gone_.contains(entity_);
  bool has_learned = false;
  for (const ltm::ModelInfo& info : reader_->manifest().models) {
    if (info.entity != entity_) continue;
    ENGRAM_ASSIGN_OR_RETURN(auto model, encoders::read_model(store_ / info.file));
    Version& version = versions_[info.version];
    version.learned = learned_from(*model, entity_, gone_);
    if (gone_.empty()) {
      ENGRAM_ASSIGN_OR_RETURN(version.learned, learned_from_forgotten(*model, entity_, *reader_));
    }
    // The self test of a model of an earlier version may be a snapshot that goes.
    const int64_t forgotten = forgotten_for(*model, entity_, reader_->manifest());
    const bool is_old = model->provenance.forgotten < 0 && (loses || forgotten > 0);
    if (knows_no_content(*model) && (is_old || !version.learned.references.empty())) {
      ENGRAM_ASSIGN_OR_RETURN(auto copy,
                              without_references(store_ / info.file, version.learned.references));
      copy->provenance.forgotten = forgotten;
      version.copy = std::make_unique<EntityCoder>(info.version, std::move(copy));
    }
    version.coder = std::make_unique<EntityCoder>(info.version, std::move(model));
    has_learned = has_learned || version.learned.is_tainted || !version.learned.references.empty();
  }
  return loses || has_learned || (gone_.empty() && !versions_.empty());
}

Result<bool> EntityErasing::is_affected(const FadingGroup& group, const Version& version) const {
  if (version.learned.is_tainted || is_cut(group)) return true;
  const auto is_gone = [this](const ltm::SnapshotEntry& entry) { return goes(entry.time); };
  if (std::ranges::any_of(group.entries, is_gone)) return true;
  std::set<const std::byte*> seen;
  const size_t images = version.coder->model->plan.images().size();
  for (const ltm::Latent& latent : codes_of(group)) {
    if (!seen.insert(latent.code.data()).second) continue;
    ENGRAM_ASSIGN_OR_RETURN(const bool begins,
                            begins_from(latent, images, version.learned.references));
    if (begins) return true;
  }
  return false;
}

Status EntityErasing::visit(const FadingGroup& group) {
  if (stop_.stop_requested()) return cancelled("erasing was stopped");
  done_ += group.entries.size();
  tell();
  const auto found = versions_.find(group.model_version());
  if (found == versions_.end())
    return data_loss("{}: latents of model v{}, which is missing", entity_.to_string(),
                     group.model_version());
  Version& version = found->second;
  ENGRAM_ASSIGN_OR_RETURN(const bool affected, is_affected(group, version));
  auto& made = made_[group.model_version()];
  if (!affected) {
    if (!version.copy) return {};
    report_.copied += group.entries.size();
    std::ranges::copy(group.latents, std::back_inserter(made));
    return {};
  }
  FadingGroup part;
  for (size_t i = 0; i < group.entries.size(); ++i) {
    if (goes(group.entries[i].time)) continue;
    if (is_recorded(group.entries[i]))
      unwanted_.insert(group.entries[i].time);
    else
      group.add_to(part, i);
  }
  if (part.entries.empty()) return {};
  report_.recoded += part.entries.size();
  if (version.learned.is_tainted) {
    tainted_.push_back({group, std::move(part)});
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(FadingGroup coded,
                          recode(group, std::move(part), version, version.target()));
  std::ranges::move(coded.latents, std::back_inserter(made));
  return {};
}

// Images of a gist are told from others, which may be those that go.
Result<std::vector<idf::Data>> EntityErasing::decoded(const FadingGroup& whole,
                                                      const FadingGroup& part,
                                                      Version& from) const {
  const std::vector<ltm::Latent> codes = codes_of(part);
  ENGRAM_ASSIGN_OR_RETURN(auto values, from.coder->decoder->decode(codes));
  if (!is_gist(part)) return values;
  std::set<uint32_t> gone, staying;
  std::vector<uint32_t> rows;
  for (const ltm::Latent& latent : codes) {
    rows.push_back(latent.place.index);
    staying.insert(latent.place.index);
  }
  // Rows that were forgotten before count as well.
  for (uint32_t row = 0; row < codes.front().place.count; ++row)
    if (!staying.contains(row)) gone.insert(row);
  for (size_t i = 0; i < whole.entries.size(); ++i)
    if (is_recorded(whole.entries[i]) && !goes(whole.entries[i].time))
      for (const ltm::LatentInstance& instance : whole.latents[i].instances)
        gone.erase(instance.latent.place.index);
  ENGRAM_ASSIGN_OR_RETURN(const GistGhosts ghosts,
                          find_ghosts(*from.coder->model, codes.front(), gone));
  ENGRAM_RETURN_IF_ERROR(replace_ghosts(*from.coder->model, ghosts, rows, values));
  return values;
}

Result<FadingGroup> EntityErasing::recode(const FadingGroup& whole, FadingGroup part, Version& from,
                                          EntityCoder& with) {
  ENGRAM_ASSIGN_OR_RETURN(const auto values, decoded(whole, part, from));
  ENGRAM_ASSIGN_OR_RETURN(const auto before, from.coder->decoder->decode(codes_of(part)));
  std::vector<ltm::Latent> latents;
  if (is_gist(part)) {
    ENGRAM_ASSIGN_OR_RETURN(latents, with.model->encode_as_gist(values, {}));
  } else {
    ENGRAM_ASSIGN_OR_RETURN(latents, with.encode(values, max_step_mse(part), stop_));
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto after, with.decoder->decode(latents));
  std::vector<ltm::LatentQuality> qualities;
  for (const ltm::LatentSnapshot& snapshot : part.latents) {
    for (const ltm::LatentInstance& instance : snapshot.instances) {
      const size_t i = qualities.size();
      ENGRAM_ASSIGN_OR_RETURN(const ltm::MeasuredError step, compare(before[i], after[i]));
      const auto& quality = qualities.emplace_back(
          joined_quality(instance.quality, step, instance.quality.faded_to_db));
      if (std::isnan(quality.error.image_mse)) continue;
      report_.expected_db = std::min(report_.expected_db, psnr_db(quality.error.image_mse));
      report_.certain_db = std::min(report_.certain_db, psnr_db(quality.certain().image_mse));
    }
  }
  part.replace(std::move(latents), qualities);
  return part;
}

Status EntityErasing::publish_new(encoders::DeepModel& model, Made latents) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Manifest manifest, ltm::read_manifest(store_));
  const int version = ltm::next_model_version(manifest, entity_);
  for (ltm::LatentSnapshot& snapshot : latents) snapshot.model_version = version;
  ENGRAM_ASSIGN_OR_RETURN(const auto file, ltm::TemporaryFile::create(store_, ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(encoders::save_model(model, file.path()));
  ENGRAM_RETURN_IF_ERROR(encoders::read_model(file.path()).status());
  return ltm::publish_model(store_, entity_, version, file.path(), latents,
                            reader_->manifest().first_journal);
}

Result<std::shared_ptr<encoders::DeepModel>> EntityErasing::fitted_to_tainted() {
  std::vector<const ltm::LatentSnapshot*> snapshots;
  TrainingSource source;
  source.entity = entity_.to_string();
  for (const Tainted& group : tainted_) {
    for (const ltm::LatentSnapshot& snapshot : group.part.latents) {
      snapshots.push_back(&snapshot);
      source.times.push_back(snapshot.time);
    }
  }
  source.read = [&](size_t index) -> Result<idf::Data> {
    const ltm::LatentSnapshot& snapshot = *snapshots[index];
    ltm::Encoder& decoder = *versions_.at(snapshot.model_version).coder->decoder;
    ENGRAM_ASSIGN_OR_RETURN(auto values, decoder.decode({&snapshot.instances.front().latent, 1}));
    return std::move(values.front());
  };
  return fitted_without_networks(std::move(source), stop_);
}

Status EntityErasing::recode_tainted() {
  if (tainted_.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto model, fitted_to_tainted());
  // They will be forgotten by then.
  const auto gone = gone_.find(entity_);
  model->provenance.forgotten = forgotten_for(*model, entity_, reader_->manifest()) +
                                static_cast<int64_t>(gone == gone_.end() ? 0 : gone->second.size());
  EntityCoder coder(0, model);
  Made made;
  for (Tainted& group : tainted_) {
    if (stop_.stop_requested()) return cancelled("erasing was stopped");
    Version& from = versions_.at(group.whole.model_version());
    ENGRAM_ASSIGN_OR_RETURN(FadingGroup coded,
                            recode(group.whole, std::move(group.part), from, coder));
    std::ranges::move(coded.latents, std::back_inserter(made));
  }
  return publish_new(*model, std::move(made));
}

Status EntityErasing::publish() {
  for (auto& [number, latents] : made_) {
    if (latents.empty()) continue;
    Version& version = versions_.at(number);
    ENGRAM_RETURN_IF_ERROR(version.copy ? publish_new(*version.copy->model, std::move(latents))
                                        : ltm::publish_latents(store_, entity_, number, latents,
                                                               reader_->manifest().first_journal));
  }
  return {};
}

Status EntityErasing::run() {
  TimeSet coded;
  {
    std::vector<Time> times;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader_->timeline(entity_));
    ENGRAM_RETURN_IF_ERROR(timeline->for_each([&times](const ltm::SnapshotEntry& entry) {
      if (entry.latent) times.push_back(entry.time);
      return Status();
    }));
    coded = TimeSet(std::move(times));
  }
  all_ = coded.size();
  ENGRAM_RETURN_IF_ERROR(for_each_group(*reader_, entity_, coded, [this](const FadingGroup& group) {
                           return visit(group);
                         }).status());
  ENGRAM_RETURN_IF_ERROR(recode_tainted());
  ENGRAM_RETURN_IF_ERROR(publish());
  report_.uncoded = unwanted_.size();
  for (const auto& [number, version] : versions_)
    if (version.learned.is_tainted || version.copy)
      report_.models.push_back(fmt::format("v{}", number));
  const auto is_tainted = [](const auto& version) { return version.second.learned.is_tainted; };
  report_.is_waiting = !unwanted_.empty() || std::ranges::any_of(versions_, is_tainted);
  return ltm::remove_latents(store_, entity_, unwanted_).status();
}

}  // namespace engram::training
