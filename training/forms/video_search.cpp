// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ltm/codec/group_codec.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

constexpr std::string_view kLossless = "ffv1";
constexpr int kFirstCrf = 24;
/// Measured on recordings at 35 dB: 0.3 dB per step of AV1, which has 63, and 0.7 of H.264 and
/// H.265, which have 51.
constexpr double kSlopeOfAv1 = 0.3, kSlopeOfOthers = 0.7;
/// A lossless video that took so many times the bytes of the lossy one is not tried in the next
/// chains, and after so many chains it is.
constexpr double kHopeless = 1.5;
constexpr size_t kMaxUntried = 64;
/// A third encode is worth what it saves only where more than so many tolerances are left.
constexpr double kLaterTolerance = 2;
/// From this number of encodes on a search halves what is left, because quality did not follow the
/// line that was expected.
constexpr size_t kMaxByLine = 4;

double worst_db(const FoundVideo& video) {
  double worst = kLargestPsnrDb;
  for (const double mse : video.mse) worst = std::min(worst, psnr_db(mse));
  return worst;
}

}  // namespace

FoundVideo* VideoSearchResult::smallest() {
  if (lossless && (!lossy || lossless->bytes.size() < lossy->bytes.size())) return &*lossless;
  return lossy ? &*lossy : nullptr;
}

VideoSearch::VideoSearch(VideoSearchOptions options)
    : options_(std::move(options)),
      max_crf_(options_.codec == "av1" ? 63 : 51),
      history_(options_.codec == "av1" ? kSlopeOfAv1 : kSlopeOfOthers) {}

Result<FoundVideo> VideoSearch::encode(std::span<const idf::NdArray> images,
                                       const std::string& codec) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto coder, ltm::make_group_codec(codec));
  FoundVideo video;
  video.codec = coder->name();
  ENGRAM_ASSIGN_OR_RETURN(video.bytes, coder->encode(images));
  if (coder->is_lossless()) {
    video.mse.assign(images.size(), 0.0);
    return video;
  }
  ENGRAM_ASSIGN_OR_RETURN(const auto decoded, coder->decode(video.bytes, images.front().type(),
                                                            images.front().shape(), images.size()));
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(video.mse.emplace_back(), image_mse(images[i], decoded[i]));
  }
  return video;
}

/// Goes by the line that earlier chains taught, then by that of this chain's trials, and halves
/// what is left if neither leads there soon.
Status VideoSearch::search_lossy(std::span<const idf::NdArray> images, const std::stop_token& stop,
                                 VideoSearchResult& result) const {
  const auto coder = ltm::make_group_codec(options_.codec);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape())) return {};
  int good = -1;           // The largest crf that is known to keep the bound.
  int bad = max_crf_ + 1;  // The smallest crf that is known to miss it.
  double spare = std::numeric_limits<double>::infinity();  // Of the best video, above the bound.
  int crf = history_.is_empty() ? kFirstCrf
                                : history_.first_guess(options_.bound_db, options_.tolerance_db);
  while (bad - good > 1) {
    if (stop.stop_requested()) return cancelled("the search for a video was stopped");
    crf = std::clamp(crf, good + 1, bad - 1);
    ENGRAM_ASSIGN_OR_RETURN(
        FoundVideo video,
        encode(images, fmt::format("{}:crf={},{}", options_.codec, crf, options_.settings)));
    video.quality = crf;
    const double worst = worst_db(video);
    result.trials.push_back({crf, worst, video.bytes.size()});
    const bool is_good = worst >= options_.bound_db;
    (is_good ? good : bad) = crf;
    if (is_good) result.lossy = std::move(video);
    if (is_good) spare = worst - options_.bound_db;
    if (spare <= options_.tolerance_db * (result.trials.size() > 1 ? kLaterTolerance : 1)) break;
    if (result.trials.size() >= kMaxByLine && good >= 0 && bad <= max_crf_) {
      crf = (good + bad) / 2;
      continue;
    }
    const double change = history_.change_to(options_.bound_db, result.trials);
    // A step more each time, so that a flat line does not creep.
    const int min_step = static_cast<int>(result.trials.size());
    crf += is_good ? std::max(static_cast<int>(std::floor(change)), 1)
                   : std::min(static_cast<int>(std::floor(change)), -min_step);
  }
  return {};
}

bool VideoSearch::may_lossless_win(const VideoSearchResult& result, size_t images) const {
  if (!result.lossy || lossless_ratio_ == 0 || lossless_ratio_ <= kHopeless) return true;
  if (untried_ >= kMaxUntried) return true;
  // Images that became as costly as the lossless ones were.
  const auto bytes = static_cast<double>(result.lossy->bytes.size());
  return bytes * kHopeless >= lossless_bytes_ * static_cast<double>(images);
}

Status VideoSearch::search_lossless(std::span<const idf::NdArray> images,
                                    VideoSearchResult& result) const {
  const auto coder = ltm::make_group_codec(kLossless);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape())) return {};
  if (!may_lossless_win(result, images.size())) return {};
  ENGRAM_ASSIGN_OR_RETURN(result.lossless, encode(images, std::string(kLossless)));
  return {};
}

Result<VideoSearchResult> VideoSearch::search(std::span<const idf::NdArray> images,
                                              const std::stop_token& stop) const {
  VideoSearchResult result;
  ENGRAM_RETURN_IF_ERROR(search_lossy(images, stop, result));
  ENGRAM_RETURN_IF_ERROR(search_lossless(images, result));
  return result;
}

void VideoSearch::learn(const VideoSearchResult& result) {
  if (!result.trials.empty()) history_.learn(result.trials, options_.bound_db);
  if (!result.lossless) {
    ++untried_;
    return;
  }
  untried_ = 0;
  if (!result.lossy) return;
  const auto images = static_cast<double>(result.lossless->mse.size());
  lossless_bytes_ = static_cast<double>(result.lossless->bytes.size()) / images;
  lossless_ratio_ = static_cast<double>(result.lossless->bytes.size()) /
                    static_cast<double>(std::max<size_t>(result.lossy->bytes.size(), 1));
}

Result<std::optional<FoundVideo>> VideoSearch::find(std::span<const idf::NdArray> images) {
  ENGRAM_ASSIGN_OR_RETURN(VideoSearchResult result, search(images));
  learn(result);
  FoundVideo* smallest = result.smallest();
  if (smallest == nullptr) return std::optional<FoundVideo>();
  return std::optional(std::move(*smallest));
}

}  // namespace engram::training
