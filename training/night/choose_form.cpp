// SPDX-License-Identifier: Apache-2.0
#include "training/night/choose_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "training/fit/network_width.h"
#include "training/forms/entity_videos.h"
#include "training/forms/video_effort.h"
#include "training/night/access_rows.h"
#include "training/night/entity_images.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// Margin of the mean PSNR of latents above the bound. Unit: dB.
constexpr double kMargin = 1.0;

/// The image members of an entity.
struct ImageMembers {
  size_t count = 0;
  int64_t pixels = 0;  ///< Of all.
  int64_t largest_pixels = 0;
};

ImageMembers image_members_of(const idf::Layout& layout) {
  ImageMembers images;
  for (const idf::TensorMember& member : layout.members()) {
    if (member.kind != idf::MemberKind::kImage) continue;
    const int64_t pixels = member.shape[0] * member.shape[1];
    ++images.count;
    images.pixels += pixels;
    images.largest_pixels = std::max(images.largest_pixels, pixels);
  }
  return images;
}

/// Sets the length of chains so that any moment is reached in the time that was asked for. It is
/// noted at once, as a job that is killed must find the same length again to go on.
Status choose_chain(const EntityWork& work, const PlannedEntity& planned,
                    const ImageMembers& images, ChosenForm& form) {
  const Duration access = work.options.access;
  if (images.count == 0 || access <= Duration::zero() || work.options.reuses_models) return {};
  NightHistory& history = form.history;
  if (!history.chain || history.chain->access != access) {
    ENGRAM_ASSIGN_OR_RETURN(const DecodingTime decoding,
                            measure_decoding(work, planned, form.representation, images.pixels));
    history.chain = {access, rows_within(access, decoding)};
    write_history(work.reader.path(), work.entity, history);
  }
  form.train.chain_rows = history.chain->rows;
  return {};
}

/// Runs of images that are coded to find out what video takes.
constexpr size_t kRuns = 4;

/// Whether coding the sample takes a small part of the time until the job ends.
bool has_time_to_sample(const EntityWork& work, const PlannedEntity& planned,
                        const ChosenForm& form) {
  constexpr double kFirstEncodes = 4;  // Of a chain, while it is unknown how quality follows crf.
  constexpr double kMaxShare = 0.05;
  const auto& until = work.options.job.until;
  if (!until) return true;
  const size_t images =
      std::min(kRuns * static_cast<size_t>(form.train.chain_rows), planned.entries.size());
  const double seconds = kFirstEncodes * static_cast<double>(images * form.image_members) *
                         seconds_per_image(usual_effort(form.image_pixels), form.image_pixels);
  return seconds <= kMaxShare * to_seconds(*until - system_now());
}

/// Bytes of the images of a snapshot as video at the bound; 0 if no codec accepts them. Only some
/// runs are coded, because coding everything would take longer than this decision is worth.
Result<double> sampled_video_bytes(const EntityWork& work, const PlannedEntity& planned,
                                   const ChosenForm& form) {
  EntityVideos& videos = *form.representation.videos;
  const auto longest = static_cast<size_t>(form.train.chain_rows);
  const auto& entries = planned.entries;
  const size_t step = std::max<size_t>(1, entries.size() / kRuns);
  double bytes = 0;
  size_t count = 0;
  for (size_t first = 0; first < entries.size(); first += step) {
    const size_t end = std::min(first + std::min(longest, step), entries.size());
    MemberImages images;
    for (size_t i = first; i < end; ++i)
      ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entries[i], images));
    for (size_t i = 0; i < images.size(); ++i) {
      VideoSearch& search = videos.search_of(i);
      ENGRAM_ASSIGN_OR_RETURN(VideoSearchResult found, search.search(images[i]));
      search.learn(found);
      videos.add(images[i], found);
      if (const FoundVideo* smallest = found.smallest())
        bytes += static_cast<double>(smallest->bytes.size());
    }
    count += end - first;
  }
  return bytes / static_cast<double>(count);
}

/// Networks that lost are tried again when there are so many times the snapshots: what is spent on
/// trials is then at most twice what the last one took.
constexpr uint64_t kTriedAgain = 2;

/// Whether an earlier night showed that networks lose, which is noted.
Result<bool> have_lost(const EntityWork& work, const PlannedEntity& planned, ChosenForm& form) {
  const uint64_t lost_at = form.history.networks_lost_at;
  const bool is_told_to = work.options.starts_anew || work.options.train.width > 0;
  if (lost_at == 0 || is_told_to || planned.representation.kind != Representation::kAuto)
    return false;
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t now, snapshots_ever(work.reader, work.entity));
  // A count that the entity never had is of another store, or made up.
  if (now < lost_at || now / kTriedAgain >= lost_at) return false;
  form.notes.push_back(fmt::format(
      "networks lost against video alone at {} snapshots: they are trained again from {} "
      "on, or with --anew",
      lost_at, kTriedAgain * lost_at));
  return true;
}

/// Whether networks may pay. Sets their width unless it is given, or notes why they do not pay.
Result<bool> wants_networks(const EntityWork& work, const PlannedEntity& planned,
                            ChosenForm& form) {
  if (work.options.reuses_models) return true;
  const RepresentationOptions& representation = planned.representation;
  if (representation.kind != Representation::kAuto)
    return representation.kind != Representation::kVideo;
  TrainOptions smallest = form.train;
  if (smallest.width == 0) smallest.width = 32;
  const uint64_t networks = network_bytes(planned.layout, smallest);
  if (networks == 0) return true;
  ENGRAM_ASSIGN_OR_RETURN(const bool lost, have_lost(work, planned, form));
  if (lost) return false;
  if (!has_time_to_sample(work, planned, form)) {
    form.notes.push_back("no time to find out whether networks pay: there is video alone");
    return false;
  }
  ENGRAM_ASSIGN_OR_RETURN(const double video, sampled_video_bytes(work, planned, form));
  if (video == 0) return true;  // No codec accepts its images.
  const double saved =
      video * static_cast<double>(planned.entries.size()) * representation.first_nights();
  if (form.train.width == 0) {
    form.train.width = width_that_pays(planned.layout, form.train, saved);
    if (form.train.width > 0) return true;
  } else if (static_cast<double>(networks) <= kMaxModelShare * saved) {
    return true;
  }
  form.notes.push_back(fmt::format(
      "video at {:.1f} dB takes {:.0f} bytes a snapshot: {:.0f} % of it in {} nights is "
      "less than what networks take ({} bytes)",
      representation.bound_db, video, 100 * kMaxModelShare, representation.first_nights(),
      networks));
  return false;
}

}  // namespace

ChosenForm ChosenForm::as_video_alone() const {
  ChosenForm video = *this;
  video.train.has_networks = false;
  video.representation.kind = Representation::kVideo;
  return video;
}

void ChosenForm::prepare_videos() {
  representation.videos =
      std::make_shared<EntityVideos>(image_members, representation.search(image_pixels));
  history.teach(*representation.videos);
}

double ChosenForm::spend(double times) {
  if (image_members == 0 || representation.video != "av1" ||
      representation.video_effort != kAutoEffort)
    return 1;
  const double tolerance_db = representation.video_tolerance_db;
  const VideoPace usual = pace_within(1, image_pixels, tolerance_db);
  const VideoPace now = pace_within(times, image_pixels, tolerance_db);
  representation.video_time = times;
  prepare_videos();
  const double more = 100 * (now.relative_bytes / usual.relative_bytes - 1);
  if (more == 0) return now.times;
  notes.push_back(fmt::format(
      "there is {:.2g} times the time that videos usually take: they are searched for with {}, "
      "within {:g} dB of the bound, which takes about {:.0f} % {} bytes than usual",
      times, now.effort->codec_options, now.tolerance_db, std::abs(more),
      more > 0 ? "more" : "fewer"));
  return now.times;
}

Result<ChosenForm> choose_form(const EntityWork& work, const PlannedEntity& planned) {
  const auto stage = work.stage(Stage::kSamples);
  ChosenForm form;
  form.train = work.options.train;
  form.representation = planned.representation;
  if (!work.options.job.is_fresh) form.history = read_history(work.reader.path(), work.entity);
  const ImageMembers images = image_members_of(planned.layout);
  ENGRAM_RETURN_IF_ERROR(choose_chain(work, planned, images, form));
  form.image_members = images.count;
  form.image_pixels = images.largest_pixels;
  form.prepare_videos();
  ENGRAM_ASSIGN_OR_RETURN(form.train.has_networks, wants_networks(work, planned, form));
  if (!form.train.has_networks) form.representation.kind = Representation::kVideo;
  // Training aims at a mean, and every image must reach the bound, so the mean must be above it.
  if (form.representation.kind == Representation::kAuto ||
      form.representation.kind == Representation::kCorrected)
    form.train.psnr_db = std::min(form.representation.bound_db + kMargin, kLargestPsnrDb);
  return form;
}

}  // namespace engram::training
