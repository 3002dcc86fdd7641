// SPDX-License-Identifier: Apache-2.0
#include "training/fade/fade_entity.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "ltm/forgetting/forget_options.h"
#include "ltm/store/publish.h"
#include "ltm/store/superseded.h"
#include "training/fade/fade_error.h"
#include "training/quality/psnr.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {

namespace {

/// Latents that would not become smaller by so much keep their bytes.
constexpr double kMinSaving = 0.05;
/// A killed job loses at most about so much work.
constexpr Duration kPublishInterval = std::chrono::minutes(2);

float faded_to(std::optional<double> psnr_db) {
  return psnr_db ? static_cast<float>(*psnr_db) : ltm::LatentQuality::kGist;
}

/// Visits how good each latent of a group is.
template <typename Visit>
void for_each_quality(const FadingGroup& group, const Visit& visit) {
  for (const ltm::LatentSnapshot& snapshot : group.latents)
    for (const ltm::LatentInstance& instance : snapshot.instances) visit(instance.quality);
}

/// PSNR of the worst images of a group, by an error of their qualities; infinite without images.
template <typename ErrorOf>
double min_db(const FadingGroup& group, const ErrorOf& error_of) {
  double min = std::numeric_limits<double>::infinity();
  for_each_quality(group, [&](const ltm::LatentQuality& quality) {
    const double mse = error_of(quality).image_mse;
    if (!std::isnan(mse)) min = std::min(min, psnr_db(mse));
  });
  return min;
}

const ltm::MeasuredError& expected_error(const ltm::LatentQuality& quality) {
  return quality.error;
}

const ltm::MeasuredError& certain_error(const ltm::LatentQuality& quality) {
  return quality.certain();
}

/// Whether an earlier job has coded a group, and was killed before it removed the other forms.
bool has_faded(const FadingGroup& group, std::optional<double> psnr_db) {
  bool has = true;
  for_each_quality(group, [&](const ltm::LatentQuality& quality) {
    has = has && quality.faded_to_db <= faded_to(psnr_db);
  });
  return has;
}

}  // namespace

EntityFading::EntityFading(const std::filesystem::path& store, const ltm::MemoryId& entity,
                           const ProgressSink& progress, const std::stop_token& stop)
    : store_(store), entity_(entity), progress_(progress), stop_(stop) {}

EntityFading::~EntityFading() = default;

Result<EntityCoder*> EntityFading::coder_of(int version) {
  if (const auto known = coders_.find(version); known != coders_.end()) return known->second.get();
  ENGRAM_ASSIGN_OR_RETURN(auto model, model_of_version(*reader_, entity_, version));
  auto coder = std::make_unique<EntityCoder>(version, std::move(model));
  return coders_.emplace(version, std::move(coder)).first->second.get();
}

Status EntityFading::run(const ltm::FadingSnapshots& what) {
  ENGRAM_ASSIGN_OR_RETURN(reader_, ltm::StoreReader::open(store_));
  published_ = system_now();
  done_ = 0;
  wanted_ = what.times.size();
  const auto fade_group = [&](FadingGroup group) -> Status {
    if (stop_.stop_requested()) return cancelled("fading was stopped");
    ENGRAM_RETURN_IF_ERROR(visit(std::move(group), what.psnr_db));
    return system_now() - published_ < kPublishInterval ? Status() : publish();
  };
  auto waiting = for_each_group(*reader_, entity_, what.times, fade_group);
  if (const Status last = fade_waiting(); waiting.ok() && !last.ok()) waiting = last;
  // What was coded by then fades even if the rest fails or the job is stopped.
  ENGRAM_RETURN_IF_ERROR(publish());
  ENGRAM_RETURN_IF_ERROR(remove_others());
  ENGRAM_RETURN_IF_ERROR(waiting.status());
  report_.waiting += *waiting;
  return {};
}

void EntityFading::tell(const std::string& detail) const {
  if (progress_) progress_({"fade " + entity_.to_string(), done_, wanted_, detail, -1});
}

Status EntityFading::visit(FadingGroup group, std::optional<double> psnr_db) {
  if (has_faded(group, psnr_db)) {
    for (const ltm::SnapshotEntry& entry : group.entries) faded_.insert(entry.time);
    report_.kept += group.entries.size();
    return {};
  }
  if (psnr_db) return fade(group, psnr_db);
  ENGRAM_ASSIGN_OR_RETURN(EntityCoder * coder, coder_of(group.model_version()));
  const bool is_full =
      !gist_.entries.empty() && (gist_.model_version() != coder->version ||
                                 gist_.rows() + group.rows() > coder->model->max_rows());
  if (is_full) ENGRAM_RETURN_IF_ERROR(fade_waiting());
  gist_.add(std::move(group));
  return {};
}

Status EntityFading::fade_waiting() {
  const FadingGroup group = std::exchange(gist_, {});
  return group.entries.empty() ? Status() : fade(group, {});
}

Status EntityFading::fade(const FadingGroup& group, std::optional<double> psnr_db) {
  ENGRAM_ASSIGN_OR_RETURN(EntityCoder * coder, coder_of(group.model_version()));
  Qualities before;
  ENGRAM_ASSIGN_OR_RETURN(const auto values, best_values(group, *coder, before));
  ENGRAM_ASSIGN_OR_RETURN(auto latents, psnr_db ? encode(*coder, values, before, *psnr_db)
                                                : encode_as_gist(*coder, values));
  FadingGroup made = group;
  if (!latents.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const auto decoded, coder->decoder->decode(latents));
    std::vector<ltm::LatentQuality> qualities;
    for (size_t i = 0; i < values.size(); ++i) {
      ENGRAM_ASSIGN_OR_RETURN(const ltm::MeasuredError step, compare(values[i], decoded[i]));
      qualities.push_back(joined_quality(before[i], step, faded_to(psnr_db)));
    }
    made.replace(std::move(latents), qualities);
  }
  done_ += group.entries.size();
  tell();
  const bool is_smaller =
      static_cast<double>(made.bytes()) <= static_cast<double>(group.bytes()) * (1 - kMinSaving);
  if (is_smaller) {
    keep(group, std::move(made), psnr_db);
  } else if (may_stay(group, *coder, values, before, psnr_db)) {
    report_.kept += group.entries.size();
    keep(group, group, psnr_db);
  } else if (made.bytes() != group.bytes()) {
    keep(group, std::move(made), psnr_db);
  } else {
    // What was recorded stays, because nothing is as good as it has to be.
    report_.kept += group.entries.size();
  }
  return {};
}

// What was recorded goes, so latents that stay have to be as good as they promise, and as good as
// what they would be replaced by.
bool EntityFading::may_stay(const FadingGroup& group, EntityCoder& coder,
                            const std::vector<idf::Data>& values, const Qualities& before,
                            std::optional<double> psnr_db) {
  const auto is_latent = [](const auto& quality) { return quality.has_value(); };
  if (std::ranges::all_of(before, is_latent)) return true;
  if (min_db(group, certain_error) < psnr_db.value_or(0)) return false;
  size_t at = 0;
  for (const ltm::LatentSnapshot& snapshot : group.latents)
    for (const ltm::LatentInstance& instance : snapshot.instances) {
      const size_t i = at++;
      if (before[i]) continue;
      const auto decoded = coder.decoder->decode({&instance.latent, 1});
      if (!decoded.ok()) return false;
      const auto found = compare(values[i], decoded->front());
      if (!found.ok() || !is_as_told(found->image_mse, instance.quality.certain().image_mse))
        return false;
    }
  return true;
}

Result<std::vector<idf::Data>> EntityFading::best_values(const FadingGroup& group,
                                                         EntityCoder& coder, Qualities& qualities) {
  std::vector<idf::Data> values;
  for (size_t i = 0; i < group.entries.size(); ++i) {
    const ltm::LatentSnapshot& latents = group.latents[i];
    const auto& recorded = group.entries[i].recorded;
    if (recorded && recorded->rows > 0) {
      ENGRAM_ASSIGN_OR_RETURN(ltm::Snapshot snapshot,
                              reader_->read_recorded(entity_, group.entries[i]));
      if (snapshot.instances.size() != latents.instances.size())
        return data_loss("'{}': found {} recorded instances and {} latents",
                         entity_.at(latents.time).to_string(), snapshot.instances.size(),
                         latents.instances.size());
      for (ltm::Instance& instance : snapshot.instances) {
        values.push_back(std::move(instance.data));
        qualities.emplace_back();
      }
      continue;
    }
    std::vector<ltm::Latent> codes;
    for (const ltm::LatentInstance& instance : latents.instances) {
      codes.push_back(instance.latent);
      qualities.emplace_back(instance.quality);
    }
    ENGRAM_ASSIGN_OR_RETURN(auto decoded, coder.decoder->decode(codes));
    std::ranges::move(decoded, std::back_inserter(values));
  }
  return values;
}

Result<std::vector<ltm::Latent>> EntityFading::encode(EntityCoder& coder,
                                                      const std::vector<idf::Data>& values,
                                                      const Qualities& before, double psnr_db) {
  const double target = mse_of_psnr(psnr_db);
  double max_mse = target;
  for (const auto& quality : before)
    if (quality && !std::isnan(quality->error.image_mse))
      max_mse = std::min(max_mse, max_step_mse(quality->error.image_mse, target));
  // More than this is no lower quality than what there is.
  if (max_mse < mse_of_psnr(ltm::FadeStep::kMaxPsnrDb)) return std::vector<ltm::Latent>();
  return coder.encode(values, max_mse, stop_);
}

Result<std::vector<ltm::Latent>> EntityFading::encode_as_gist(
    EntityCoder& coder, const std::vector<idf::Data>& values) {
  const size_t images = values.size() * std::max<size_t>(1, coder.model->plan.images().size());
  return coder.gist.find(images, [&](const encoders::GistOptions& options) {
    using Latents = std::vector<ltm::Latent>;
    if (stop_.stop_requested()) return Result<Latents>(cancelled("fading was stopped"));
    tell(fmt::format("gist of {} images at crf {}", images, options.crf));
    return coder.model->encode_as_gist(values, options);
  });
}

void EntityFading::keep(const FadingGroup& group, FadingGroup made, std::optional<double> psnr_db) {
  if (made.bytes() != group.bytes()) count(group, made);
  for (ltm::LatentSnapshot& snapshot : made.latents) {
    for (ltm::LatentInstance& instance : snapshot.instances)
      instance.quality.faded_to_db = faded_to(psnr_db);
    faded_.insert(snapshot.time);
  }
  auto& all = made_[made.latents.front().model_version];
  std::ranges::move(made.latents, std::back_inserter(all));
}

void EntityFading::count(const FadingGroup& before, const FadingGroup& after) {
  report_.faded += before.entries.size();
  report_.bytes_before += before.bytes();
  report_.bytes_after += after.bytes();
  report_.expected_db = std::min(report_.expected_db, min_db(after, expected_error));
  report_.certain_db = std::min(report_.certain_db, min_db(after, certain_error));
}

Status EntityFading::publish() {
  for (const auto& [version, latents] : made_)
    ENGRAM_RETURN_IF_ERROR(
        ltm::publish_latents(store_, entity_, version, latents, reader_->manifest().first_journal));
  made_.clear();
  published_ = system_now();
  return {};
}

// A job that was killed before this left forms that the next one removes.
Status EntityFading::remove_others() {
  if (faded_.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, ltm::StoreReader::open(store_));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, reader->timeline(entity_));
  TimeSet keep;
  bool is_any_recorded = false;
  ENGRAM_RETURN_IF_ERROR(timeline->for_each([&](const ltm::SnapshotEntry& entry) {
    if (!entry.recorded) return Status();
    const bool is_faded = faded_.contains(entry.time);
    if (!is_faded) keep.insert(entry.time);
    is_any_recorded = is_any_recorded || is_faded;
    return Status();
  }));
  faded_ = {};
  if (is_any_recorded) ENGRAM_RETURN_IF_ERROR(ltm::drop_recorded(store_, entity_, keep).status());
  return ltm::remove_superseded_latents(store_, entity_).status();
}

}  // namespace engram::training
