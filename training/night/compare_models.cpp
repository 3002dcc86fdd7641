// SPDX-License-Identifier: Apache-2.0
#include "training/night/compare_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "training/night/model_of_latents.h"
#include "training/night/previous_model.h"

namespace engram::training {

namespace {

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

/// Nights like this one that a new model will probably serve: as many as the one that it replaces
/// did, this one included. Models that come in a quick succession then have to pay soon.
Result<int64_t> nights_of_model(const EntityWork& work, const PlannedEntity& planned,
                                const ltm::ModelInfo& newest) {
  const RepresentationOptions& options = work.options.representation;
  if (options.nights) return int64_t{*options.nights};
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, work.reader.index(work.entity));
  const auto served = std::ranges::count_if(*index, [&](const ltm::SnapshotEntry& entry) {
    return version_of_latents(work, entry) == newest.version;
  });
  const auto news = static_cast<int64_t>(std::max<uint64_t>(planned.plan.new_snapshots, 1));
  return std::clamp<int64_t>((served + news) / news, 1, RepresentationOptions::kFirstNights);
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
                                      uint64_t model_bytes, const EncodingLimits& limits) {
  ComparedModels compared;
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  if (!planned.compares_models(work.options) || newest == nullptr) return compared;
  const auto previous = usable_model(work, planned, form, *newest, compared.notes);
  if (!previous) return compared;
  const auto no_time = [&] {
    compared.notes.push_back(not_compared(*newest, "the time was over"));
    return compared;
  };
  if (made.snapshots < planned.entries.size()) return no_time();
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
  auto encoded = encode_entity(work, previous, newest->version, rest, representation, limits);
  if (encoded.status().code() == StatusCode::kInvalidArgument) {
    compared.notes.push_back(not_compared(*newest, encoded.status().message()));
    return compared;
  }
  ENGRAM_RETURN_IF_ERROR(encoded.status());
  if (encoded->snapshots < rest.size()) return no_time();
  before.add(rest, encoded->latents);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_needed, is_needed_anyway(work, planned, *newest));
  ENGRAM_ASSIGN_OR_RETURN(const int64_t nights, nights_of_model(work, planned, *newest));
  compared.choice = {newest->version,
                     static_cast<int64_t>(planned.entries.size()),
                     static_cast<int64_t>(planned.plan.new_snapshots),
                     nights,
                     before.with_model(is_needed ? 0 : newest->bytes),
                     now.with_model(model_bytes)};
  compared.notes.push_back(told(compared.choice));
  compared.previous = *std::move(encoded);
  return compared;
}

}  // namespace engram::training
