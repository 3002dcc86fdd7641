// SPDX-License-Identifier: Apache-2.0
#include "training/night/compare_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/idf/binary.h"
#include "training/night/model_of_latents.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

using Model = std::shared_ptr<encoders::DeepModel>;

/// Bytes of a snapshot's latents: its share of its blocks, and its remainder.
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

/// Sums over snapshots, separate for those that had latents before.
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

std::string not_compared(const ltm::ModelInfo& newest, std::string_view why) {
  return fmt::format("v{} was not compared with: {}", newest.version, why);
}

/// Returns the newest model if it can encode these snapshots with the requested options; else null,
/// with a note.
Model usable_model(const EntityWork& work, const PlannedEntity& planned, const ChosenForm& form,
                   const ltm::ModelInfo& newest, std::vector<std::string>& notes) {
  auto model = encoders::read_model(work.reader.path() / newest.file);
  const auto unusable = [&](std::string_view why) {
    notes.push_back(not_compared(newest, why));
    return Model();
  };
  if (!model.ok()) return unusable(model.status().message());
  if (!((*model)->plan.layout() == planned.layout)) return unusable("it has another layout");
  if ((*model)->provenance.number_bound != form.train.number_bound)
    return unusable("it keeps numbers within another bound");
  return *std::move(model);
}

/// Bytes of the newest model's latents of a snapshot; nothing if it has none within the bound.
Result<std::optional<double>> known_bytes(const EntityWork& work, const PlannedEntity& planned,
                                          const encoders::DeepModel& newest,
                                          const ltm::SnapshotEntry& entry) {
  using Bytes = std::optional<double>;
  if (version_of_latents(work, entry) != planned.plan.newest_version) return Bytes();
  const double bound_db = planned.representation.bound_db;
  // The measured error is the mean over all images, which does not show that each one keeps the
  // bound.
  if (newest.plan.images().size() > 1 && newest.provenance.forms.bound_db < bound_db)
    return Bytes();
  ENGRAM_ASSIGN_OR_RETURN(const auto latents, work.reader.read_latent(work.entity, entry));
  for (const ltm::LatentInstance& instance : latents.instances) {
    const double mse = instance.error.image_mse;
    if (!std::isnan(mse) && psnr_db(mse) < bound_db) return Bytes();
  }
  return Bytes(bytes_of(latents));
}

/// Whether latents of the newest model remain after those of all planned snapshots are replaced.
/// Then its file stays in any case.
Result<bool> is_needed_anyway(const EntityWork& work, const PlannedEntity& planned,
                              const ltm::ModelInfo& newest) {
  const auto is_of_newest = [&](const ltm::SnapshotEntry& entry) {
    return version_of_latents(work, entry) == newest.version;
  };
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, work.reader.index(work.entity));
  return std::ranges::count_if(*index, is_of_newest) >
         std::ranges::count_if(planned.entries, is_of_newest);
}

std::string told(const encoders::ModelChoice& choice) {
  return fmt::format(
      "in {} night{}, going on with v{} takes {:.0f} bytes, a new model {:.0f}: {}", choice.nights,
      choice.nights == 1 ? "" : "s", choice.previous_version, choice.previous.total(choice.nights),
      choice.made.total(choice.nights),
      choice.keeps_previous() ? "no new one was published" : "the new one was published");
}

}  // namespace

std::optional<std::string> why_video_is_cheaper(const EncodedEntity& made, uint64_t model_bytes,
                                                int nights) {
  const encoders::StoredForms& forms = made.quality.forms;
  const double with_networks =
      static_cast<double>(forms.kept_bytes) * nights + static_cast<double>(model_bytes);
  const double video = static_cast<double>(forms.video_bytes) * nights;
  if (forms.video_bytes == 0 || with_networks <= video) return std::nullopt;
  return fmt::format(
      "networks and the cheaper of latents and video take {:.0f} bytes in {} nights, video alone "
      "{:.0f}",
      with_networks, nights, video);
}

Result<ComparedModels> compare_models(const EntityWork& work, const PlannedEntity& planned,
                                      const ChosenForm& form, const EncodedEntity& made,
                                      uint64_t model_bytes) {
  ComparedModels compared;
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  if (work.options.representation.kind != Representation::kAuto || newest == nullptr)
    return compared;
  const Model previous = usable_model(work, planned, form, *newest, compared.notes);
  if (!previous) return compared;
  PayloadSum before, now;
  now.add(planned.entries, made.latents);
  std::vector<ltm::SnapshotEntry> rest;
  for (const ltm::SnapshotEntry& entry : planned.entries) {
    ENGRAM_ASSIGN_OR_RETURN(const auto bytes, known_bytes(work, planned, *previous, entry));
    if (bytes)
      before.add(entry, *bytes);
    else
      rest.push_back(entry);
  }
  // The planned representation is used, because the new model may now be one of video alone. The
  // bound is the same, and so are the videos.
  RepresentationOptions representation = planned.representation;
  representation.videos = form.representation.videos;
  auto encoded = encode_entity(work, previous, newest->version, rest, representation);
  if (encoded.status().code() == StatusCode::kInvalidArgument) {
    compared.notes.push_back(not_compared(*newest, encoded.status().message()));
    return compared;
  }
  if (!encoded.ok()) {
    compared.skipped = skipped_by(encoded.status(), work.pace);
    if (!compared.skipped) return encoded.status();
    return compared;
  }
  before.add(rest, encoded->latents);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_needed, is_needed_anyway(work, planned, *newest));
  compared.choice = {newest->version,
                     static_cast<int64_t>(planned.entries.size()),
                     static_cast<int64_t>(planned.plan.new_snapshots),
                     work.options.representation.nights,
                     before.with_model(is_needed ? 0 : newest->bytes),
                     now.with_model(model_bytes)};
  compared.notes.push_back(told(compared.choice));
  compared.previous = *std::move(encoded);
  return compared;
}

}  // namespace engram::training
