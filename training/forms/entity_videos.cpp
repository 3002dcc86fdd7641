// SPDX-License-Identifier: Apache-2.0
#include "training/forms/entity_videos.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "ltm/codec/group_codec.h"
#include "ltm/core/mutex.h"
#include "ltm/store/checksum.h"
#include "training/forms/video_correction.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

/// A day's images of one camera of 640 x 480 pixels take 100 MB.
constexpr uint64_t kMaxBytes = uint64_t{256} << 20;

uint64_t key_of(std::span<const idf::NdArray> images) {
  std::vector<uint64_t> sums;
  for (const idf::NdArray& image : images) {
    sums.push_back(ltm::checksum(image.bytes()));
    for (const int64_t size : image.shape()) sums.push_back(static_cast<uint64_t>(size));
  }
  return ltm::checksum(std::as_bytes(std::span(sums)));
}

/// Whether a video begins from nothing, or from a reference that the search uses.
bool has_references(const VideoSearch& search, const std::optional<FoundVideo>& video) {
  if (!video || video->form != encoders::ImageForm::kPackedAv1) return true;
  const auto reference = encoders::reference_of_video(video->bytes);
  return reference.ok() && (!*reference || search.find_reference(**reference) != nullptr);
}

std::string_view codec_of(encoders::ImageForm form) {
  return form == encoders::ImageForm::kPackedAv1 ? "av1" : encoders::codec_name(form);
}

/// The references that a stored video may begin from: the one that it names, if it is in use.
std::vector<encoders::VideoReference> references_for(const VideoSearch& search,
                                                     std::span<const std::byte> packed) {
  const auto name = encoders::reference_of_video(packed);
  if (!name.ok() || !*name) return {};
  const encoders::VideoReference* found = search.find_reference(**name);
  return found != nullptr ? std::vector{*found} : std::vector<encoders::VideoReference>();
}

uint64_t bytes_of_video(const VideoSearchResult& found) {
  return (found.lossy ? found.lossy->size() : 0) + (found.lossless ? found.lossless->size() : 0);
}

}  // namespace

/// Videos by the key of their images.
struct EntityVideos::Found {
  Mutex mutex;
  std::unordered_map<uint64_t, VideoSearchResult> of_key ENGRAM_GUARDED_BY(mutex);
  uint64_t bytes ENGRAM_GUARDED_BY(mutex) = 0;
  uint64_t reused ENGRAM_GUARDED_BY(mutex) = 0;
};

EntityVideos::EntityVideos(size_t members, const VideoSearchOptions& options)
    : searches_(members, VideoSearch(options)), found_(std::make_unique<Found>()) {}

EntityVideos::~EntityVideos() = default;

std::shared_ptr<EntityVideos> EntityVideos::without_videos() const {
  auto copy = std::make_shared<EntityVideos>(0, VideoSearchOptions());
  copy->searches_ = searches_;
  return copy;
}

std::optional<VideoSearchResult> EntityVideos::find(size_t member,
                                                    std::span<const idf::NdArray> images) const {
  const uint64_t key = key_of(images);
  const MutexLock lock(found_->mutex);
  const auto found = found_->of_key.find(key);
  if (found == found_->of_key.end() || !has_references(searches_[member], found->second.lossy))
    return std::nullopt;
  ++found_->reused;
  return found->second;
}

void EntityVideos::add(std::span<const idf::NdArray> images, const VideoSearchResult& found) {
  const uint64_t key = key_of(images);
  const uint64_t bytes = bytes_of_video(found);
  const MutexLock lock(found_->mutex);
  if (bytes == 0 || found_->bytes + bytes > kMaxBytes) return;
  if (found_->of_key.emplace(key, found).second) found_->bytes += bytes;
}

Status EntityVideos::add_stored(size_t member, std::span<const idf::NdArray> images,
                                encoders::ImageForm form, std::span<const std::byte> bytes,
                                std::span<const std::byte> residual) {
  const ltm::GroupCodec* coder = ltm::find_group_codec(codec_of(form));
  const VideoSearch& search = searches_[member];
  const VideoSearchOptions& options = search.options();
  if (coder == nullptr || (!coder->is_lossless() && coder->name() != options.codec)) return {};
  FoundVideo video{{bytes.begin(), bytes.end()}, {residual.begin(), residual.end()}, form, 0, {}};
  VideoSearchResult found;
  if (coder->is_lossless()) {
    video.mse.assign(images.size(), 0.0);
    found.lossless = std::move(video);
    add(images, found);
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(
      auto decoded,
      encoders::decode_stored_video(form, bytes, {images.front().type(), images.front().shape()},
                                    images.size(), images.size(), references_for(search, bytes)));
  if (!residual.empty()) ENGRAM_RETURN_IF_ERROR(apply_residuals(residual, decoded));
  double worst = kLargestPsnrDb;
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(video.mse.emplace_back(), image_mse(images[i], decoded[i]));
    worst = std::min(worst, psnr_db(video.mse.back()));
  }
  if (worst < options.bound_db) return {};
  found.lossy = std::move(video);
  add(images, found);
  return {};
}

uint64_t EntityVideos::reused() const {
  const MutexLock lock(found_->mutex);
  return found_->reused;
}

}  // namespace engram::training
