// SPDX-License-Identifier: Apache-2.0
#include "training/night/choose_form.h"

#include <fmt/format.h>

#include <algorithm>

#include "training/fit/network_width.h"
#include "training/forms/video_search.h"
#include "training/night/entity_images.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// Margin of the mean PSNR of latents above the bound. Unit: dB.
constexpr double kMargin = 1.0;

/// Bytes of the images of a snapshot as video at the bound; 0 if no codec accepts them. Only some
/// runs are coded, because coding everything would take longer than this decision is worth.
Result<double> sampled_video_bytes(const EntityWork& work, const PlannedEntity& planned) {
  constexpr size_t kRuns = 4;
  const auto longest = static_cast<size_t>(work.options.train.chain_rows);
  const auto& entries = planned.entries;
  const size_t step = std::max<size_t>(1, entries.size() / kRuns);
  const RepresentationOptions& representation = planned.representation;
  double bytes = 0;
  size_t count = 0;
  for (size_t first = 0; first < entries.size(); first += step) {
    const size_t end = std::min(first + std::min(longest, step), entries.size());
    MemberImages images;
    for (size_t i = first; i < end; ++i)
      ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entries[i], images));
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
  ENGRAM_ASSIGN_OR_RETURN(const double video, sampled_video_bytes(work, planned));
  if (video == 0) return true;  // No codec accepts its images.
  const double saved = video * static_cast<double>(planned.entries.size()) * representation.nights;
  if (form.train.width == 0) {
    form.train.width = width_that_pays(planned.layout, form.train, saved);
    if (form.train.width > 0) return true;
  } else if (static_cast<double>(networks) <= kMaxModelShare * saved) {
    return true;
  }
  form.notes.push_back(fmt::format(
      "video at {:.1f} dB takes {:.0f} bytes a snapshot: {:.0f} % of it in {} nights is "
      "less than what networks take ({} bytes)",
      representation.bound_db, video, 100 * kMaxModelShare, representation.nights, networks));
  return false;
}

}  // namespace

ChosenForm ChosenForm::as_video_alone() const {
  ChosenForm video = *this;
  video.train.has_networks = false;
  video.representation.kind = Representation::kVideo;
  return video;
}

Result<ChosenForm> choose_form(const EntityWork& work, const PlannedEntity& planned) {
  ChosenForm form{work.options.train, planned.representation, {}};
  ENGRAM_ASSIGN_OR_RETURN(form.train.has_networks, wants_networks(work, planned, form));
  if (!form.train.has_networks) form.representation.kind = Representation::kVideo;
  // Training aims at a mean, and every image must reach the bound, so the mean must be above it.
  if (form.representation.kind == Representation::kAuto ||
      form.representation.kind == Representation::kCorrected)
    form.train.psnr_db = std::min(form.representation.bound_db + kMargin, kLargestPsnrDb);
  return form;
}

}  // namespace engram::training
