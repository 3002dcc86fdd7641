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

std::optional<VideoSearchResult> EntityVideos::find(std::span<const idf::NdArray> images) const {
  const uint64_t key = key_of(images);
  const MutexLock lock(found_->mutex);
  const auto found = found_->of_key.find(key);
  if (found == found_->of_key.end()) return std::nullopt;
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
                                const std::string& codec, std::span<const std::byte> bytes,
                                std::span<const std::byte> residual) {
  const ltm::GroupCodec* coder = ltm::find_group_codec(codec);
  const VideoSearchOptions& options = searches_[member].options();
  if (coder == nullptr || (!coder->is_lossless() && codec != options.codec)) return {};
  FoundVideo video{{bytes.begin(), bytes.end()}, {residual.begin(), residual.end()}, codec, 0, {}};
  VideoSearchResult found;
  if (coder->is_lossless()) {
    video.mse.assign(images.size(), 0.0);
    found.lossless = std::move(video);
    add(images, found);
    return {};
  }
  ENGRAM_ASSIGN_OR_RETURN(auto decoded, coder->decode(bytes, images.front().type(),
                                                      images.front().shape(), images.size()));
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
