// SPDX-License-Identifier: Apache-2.0
// What a job on an entity does with the model that the entity has already.
#include <algorithm>
#include <cmath>

#include "encoders/deep_model_file.h"
#include "ltm/idf/binary.h"
#include "ltm/store/publish.h"
#include "training/night/entity_job.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// Bytes of a snapshot's latents: its part of its blocks, and what is no tensor.
double bytes_of(const ltm::LatentSnapshot& snapshot) {
  double bytes = 0;
  for (const ltm::LatentInstance& instance : snapshot.instances) {
    const ltm::Latent& latent = instance.latent;
    bytes += static_cast<double>(latent.code.size()) / latent.place.count;
    if (!latent.remainder.empty())
      bytes += static_cast<double>(idf::encoded_size(idf::Data(latent.remainder)));
  }
  return bytes;
}

/// Sums over snapshots, apart for those that had latents before.
struct PayloadSum {
  double known = 0;
  double news = 0;

  void add(const ltm::SnapshotEntry& entry, double bytes) {
    (entry.latent ? known : news) += bytes;
  }
  /// Shape: a latent per entry.
  void add(std::span<const ltm::SnapshotEntry> entries,
           const std::vector<ltm::LatentSnapshot>& latents) {
    for (size_t i = 0; i < entries.size(); ++i) add(entries[i], bytes_of(latents[i]));
  }
  [[nodiscard]] encoders::ModelBytes with_model(uint64_t model) const {
    return {std::llround(known), std::llround(news), static_cast<int64_t>(model)};
  }
};

}  // namespace

int EntityJob::version_of(const ltm::SnapshotEntry& entry) const {
  if (!entry.latent) return 0;  // It is in no journal.
  const auto* entity = reader_.manifest().segments[entry.latent->source].find(entity_);
  return entity == nullptr ? 0 : entity->latent.model_version;
}

Status EntityJob::encode_with_newest() {
  const ltm::ModelInfo* newest = reader_.manifest().newest_model(entity_);
  if (newest == nullptr) return skip(fmt::format("{}: has no model yet", entity_.to_string()));
  ENGRAM_ASSIGN_OR_RETURN(const auto model, encoders::read_model(reader_.path() / newest->file));
  std::vector<ltm::SnapshotEntry> entries = entries_;
  if (!options_.force)
    std::erase_if(entries,
                  [](const ltm::SnapshotEntry& entry) { return entry.latent.has_value(); });
  const auto latents = encode(model, newest->version, entries, representation_, report_);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_encoded, goes_on_after(latents.status()));
  if (!is_encoded) return {};
  report_.model_version = newest->version;
  report_.model_bytes = newest->bytes;
  return ltm::publish_latents(reader_.path(), entity_, newest->version, *latents,
                              reader_.manifest().first_journal);
}

Result<std::shared_ptr<encoders::DeepModel>> EntityJob::usable_previous() {
  const ltm::ModelInfo* newest = reader_.manifest().newest_model(entity_);
  using Model = std::shared_ptr<encoders::DeepModel>;
  if (newest == nullptr) return Model();
  const auto unusable = [&](const std::string& why) {
    report_.notes.push_back(fmt::format("v{} was not compared with: {}", newest->version, why));
    return Model();
  };
  auto model = encoders::read_model(reader_.path() / newest->file);
  if (!model.ok()) return unusable(model.status().message());
  if (!((*model)->plan.layout() == layout_)) return unusable("it has another layout");
  if ((*model)->provenance.number_bound != train_.number_bound)
    return unusable("it keeps numbers within another bound");
  return model;
}

Result<std::optional<double>> EntityJob::known_bytes(const encoders::DeepModel& previous,
                                                     const ltm::SnapshotEntry& entry) {
  using Bytes = std::optional<double>;
  if (version_of(entry) != plan_.newest_version) return Bytes();
  const double bound_db = representation_.bound_db;
  // What was measured is the mean over several images.
  if (previous.plan.images().size() > 1 && previous.provenance.forms.bound_db < bound_db)
    return Bytes();
  ENGRAM_ASSIGN_OR_RETURN(const auto latents, reader_.read_latent(entity_, entry));
  for (const ltm::LatentInstance& instance : latents.instances) {
    const double mse = instance.error.image_mse;
    if (!std::isnan(mse) && psnr_db(mse) < bound_db) return Bytes();
  }
  return Bytes(bytes_of(latents));
}

Result<bool> EntityJob::is_previous_needed() {
  const int newest = reader_.manifest().newest_model(entity_)->version;
  const auto is_of_newest = [&](const ltm::SnapshotEntry& entry) {
    return version_of(entry) == newest;
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, reader_.index(entity_));
  return std::ranges::count_if(*index, is_of_newest) >
         std::ranges::count_if(entries_, is_of_newest);
}

Result<bool> EntityJob::goes_on_with_previous() {
  if (options_.representation.kind != Representation::kAuto) return false;
  ENGRAM_ASSIGN_OR_RETURN(const auto previous, usable_previous());
  if (!previous) return false;
  const ltm::ModelInfo newest = *reader_.manifest().newest_model(entity_);
  PayloadSum before, now;
  now.add(entries_, latents_);
  std::vector<ltm::SnapshotEntry> rest;
  for (const ltm::SnapshotEntry& entry : entries_) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, known_bytes(*previous, entry));
    if (bytes)
      before.add(entry, *bytes);
    else
      rest.push_back(entry);
  }
  EntityReport measured;
  // The new model may have become one of video alone; the bound is the same.
  RepresentationOptions representation = representation_;
  representation.kind = Representation::kAuto;
  auto latents = encode(previous, newest.version, rest, representation, measured);
  if (latents.status().code() == StatusCode::kInvalidArgument) {
    report_.notes.push_back(
        fmt::format("v{} was not compared with: {}", newest.version, latents.status().message()));
    return false;
  }
  ENGRAM_ASSIGN_OR_RETURN(const bool is_encoded, goes_on_after(latents.status()));
  if (!is_encoded) return false;
  before.add(rest, *latents);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_needed, is_previous_needed());
  encoders::ModelChoice& choice = report_.choice;
  choice = {newest.version,
            static_cast<int64_t>(entries_.size()),
            static_cast<int64_t>(plan_.new_snapshots),
            options_.representation.nights,
            before.with_model(is_needed ? 0 : newest.bytes),
            now.with_model(report_.model_bytes)};
  report_.notes.push_back(fmt::format(
      "in {} night{}, going on with v{} takes {:.0f} bytes, a new model {:.0f}: {}", choice.nights,
      choice.nights == 1 ? "" : "s", newest.version, choice.previous.total(choice.nights),
      choice.made.total(choice.nights),
      choice.keeps_previous() ? "no new one was published" : "the new one was published"));
  if (!choice.keeps_previous()) {
    ENGRAM_RETURN_IF_ERROR(save());
    return false;
  }
  latents_ = *std::move(latents);
  measured.entity = entity_;
  measured.model_version = newest.version;
  measured.model_bytes = newest.bytes;
  measured.left_behind = report_.left_behind;
  measured.stored_bytes = report_.stored_bytes;
  measured.choice = choice;
  measured.notes = std::move(report_.notes);
  measured.encoding_seconds = report_.encoding_seconds;
  measured.expected_encoding_seconds = report_.expected_encoding_seconds;
  measured.training = std::move(report_.training);
  report_ = std::move(measured);
  return true;
}

}  // namespace engram::training
