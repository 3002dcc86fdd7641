// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_references.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/core/sequences.h"
#include "training/forms/entity_videos.h"
#include "training/forms/reference_choice.h"
#include "training/forms/video_effort.h"
#include "training/night/entity_images.h"

namespace engram::training {

namespace {

using References = std::vector<encoders::OpenReference>;

/// With fewer chains nothing is left after what a reference takes.
constexpr double kMinChains = 4;
constexpr size_t kMaxSamples = 12, kMinSamples = 4;
constexpr int kMaxTried = 4;
/// Images of a run that is coded to find out which quality the bound needs.
constexpr size_t kFirstRun = 16;
/// The choice takes at most this share of the time that is left for encoding.
constexpr double kMaxShareOfTime = 0.1;

double chains_of(const PlannedEntity& planned, size_t chain_rows) {
  std::vector<Time> times;
  for (const ltm::SnapshotEntry& entry : planned.entries) times.push_back(entry.time);
  double chains = 0;
  for (const Sequence& recording : cut_recordings(times))
    chains += std::ceil(static_cast<double>(recording.size()) / static_cast<double>(chain_rows));
  return chains;
}

/// Whether an image can be coded from another one.
bool is_codable(const idf::NdArray& image) {
  return image.type() == idf::ElementType::kUInt8 && image.shape().size() == 3;
}

/// Learns how quality follows from crf, if nobody knows.
Status learn_quality(const EntityWork& work, const PlannedEntity& planned, size_t member,
                     EntityVideos& videos) {
  VideoSearch& search = videos.search_of(member);
  if (!search.history().is_empty()) return {};
  MemberImages images;
  for (const auto& entry :
       std::span(planned.entries).first(std::min(kFirstRun, planned.entries.size())))
    ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entry, images));
  ENGRAM_ASSIGN_OR_RETURN(const VideoSearchResult found,
                          search.search(images[member], work.pace.stop()));
  search.learn(found);
  videos.add(images[member], found);
  return {};
}

/// Evenly spaced images of all members.
Result<std::vector<std::vector<ReferenceSample>>> samples_of(const EntityWork& work,
                                                             const PlannedEntity& planned,
                                                             size_t count) {
  std::vector<std::vector<ReferenceSample>> samples;
  for (size_t i = 0; i < count; ++i) {
    const auto& entry = planned.entries[(2 * i + 1) * planned.entries.size() / (2 * count)];
    MemberImages images;
    ENGRAM_RETURN_IF_ERROR(append_images(work, planned.layout, entry, images));
    samples.resize(images.size());
    for (size_t member = 0; member < images.size(); ++member)
      samples[member].push_back({entry.time, images[member].front()});
  }
  return samples;
}

/// The codec of the newest model, with those references that may be taken over; nothing without one
/// of this layout.
Result<std::optional<encoders::LatentChainCodec>> newest_codec(const EntityWork& work,
                                                               const idf::Layout& layout) {
  using Codec = std::optional<encoders::LatentChainCodec>;
  const ltm::ModelInfo* newest = work.reader.manifest().newest_model(work.entity);
  if (newest == nullptr || work.options.starts_anew) return Codec();
  const auto model = encoders::read_model(work.reader.path() / newest->file);
  if (!model.ok() || !((*model)->plan.layout() == layout)) return Codec();
  Codec codec = (*model)->codec.chain;
  for (auto& references : codec->references) {
    std::vector<encoders::VideoReference> remembered;
    for (encoders::VideoReference& reference : references) {
      ENGRAM_ASSIGN_OR_RETURN(const bool is_there, is_remembered(work, reference));
      if (is_there) remembered.push_back(std::move(reference));
    }
    references = std::move(remembered);
  }
  return codec;
}

bool has_time(const EntityWork& work, const Allotment& time, const ChosenForm& form,
              double encodes) {
  const auto end = time.encoded_end ? time.encoded_end : time.end;
  if (!end) return true;
  const double seconds =
      encodes * seconds_per_image(usual_effort(form.image_pixels), form.image_pixels);
  return seconds <= kMaxShareOfTime * to_seconds(*end - work.pace.now());
}

}  // namespace

Result<bool> is_remembered(const EntityWork& work, const encoders::VideoReference& reference) {
  ENGRAM_ASSIGN_OR_RETURN(const auto* index, work.reader.index(work.entity));
  return std::ranges::binary_search(*index, time_from_ns(reference.time), {},
                                    &ltm::SnapshotEntry::time);
}

Status add_references(const EntityWork& work, const PlannedEntity& planned, const ChosenForm& form,
                      const Allotment& time, encoders::DeepModel& model) {
  const auto& videos = form.representation.videos;
  const size_t members = model.plan.images().size();
  if (form.representation.video != "av1" || !videos || videos->members() != members) return {};
  const double chains = chains_of(planned, model.codec.chain_rows);
  if (chains < kMinChains || planned.entries.size() < kFirstRun) return {};
  const auto stage = work.stage(Stage::kSamples);
  const auto samples = std::clamp(static_cast<size_t>(chains / 2), kMinSamples, kMaxSamples);
  const int tried = std::clamp(static_cast<int>(chains / 4), 1, kMaxTried);
  // A sample from a reference has two images, and a reference is made of five.
  const double encodes =
      static_cast<double>(members) *
      (static_cast<double>(samples) * (1 + 2 * tried) + 5.0 * tried + 4.0 * kFirstRun);
  if (!has_time(work, time, form, encodes)) return {};
  ENGRAM_ASSIGN_OR_RETURN(const auto images, samples_of(work, planned, samples));
  ENGRAM_ASSIGN_OR_RETURN(const auto newest, newest_codec(work, planned.layout));
  auto& references = model.codec.chain.references;
  references.assign(members, {});
  for (size_t i = 0; i < members; ++i) {
    if (!is_codable(images[i].front().image)) continue;
    ENGRAM_RETURN_IF_ERROR(learn_quality(work, planned, i, *videos));
    const VideoSearch& search = videos->search_of(i);
    if (search.history().is_empty()) continue;
    const VideoSearchOptions& options = search.options();
    ENGRAM_ASSIGN_OR_RETURN(
        const auto chosen,
        choose_references(
            images[i], newest ? open_references(*newest, i) : References(),
            {.chains = chains,
             .crf = search.history().first_guess(options.bound_db, options.tolerance_db),
             .settings = options.settings,
             .max_tried = tried},
            work.pace.stop()));
    for (const encoders::OpenReference& one : chosen) references[i].push_back(one.reference);
  }
  return {};
}

}  // namespace engram::training
