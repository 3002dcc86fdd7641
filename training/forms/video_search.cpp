// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_search.h"

#include <algorithm>

#include "ltm/codec/group_codec.h"
#include "training/quality/psnr.h"

namespace engram::training {

namespace {

constexpr std::string_view kLossless = "ffv1";
constexpr int kFirstCrf = 24;

}  // namespace

VideoSearch::VideoSearch(std::string codec, int effort, double bound_db)
    : codec_(std::move(codec)),
      effort_(effort),
      bound_db_(bound_db),
      max_crf_(codec_ == "av1" ? 63 : 51),
      crf_(kFirstCrf) {}

bool VideoSearch::is_within(const FoundVideo& video) const {
  return std::ranges::all_of(video.mse, [&](double mse) { return psnr_db(mse) >= bound_db_; });
}

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

Result<std::optional<FoundVideo>> VideoSearch::find_lossless(
    std::span<const idf::NdArray> images) const {
  const auto coder = ltm::make_group_codec(kLossless);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape()))
    return std::optional<FoundVideo>();
  ENGRAM_ASSIGN_OR_RETURN(FoundVideo video, encode(images, std::string(kLossless)));
  return std::optional(std::move(video));
}

/// Doubles the step until the bound lies between two qualities, then bisects.
Result<std::optional<FoundVideo>> VideoSearch::find_lossy(std::span<const idf::NdArray> images) {
  const auto coder = ltm::make_group_codec(codec_);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape()))
    return std::optional<FoundVideo>();
  std::optional<FoundVideo> best;
  int good = -1;           // The largest crf that is known to keep the bound.
  int bad = max_crf_ + 1;  // The smallest crf that is known to miss it.
  int step = 1;
  for (int crf = std::clamp(crf_, 0, max_crf_); bad - good > 1;) {
    ENGRAM_ASSIGN_OR_RETURN(
        FoundVideo video, encode(images, fmt::format("{}:crf={},effort={}", codec_, crf, effort_)));
    video.quality = crf;
    const bool is_good = is_within(video);
    (is_good ? good : bad) = crf;
    if (is_good) best = std::move(video);
    const bool is_bracketed = good >= 0 && bad <= max_crf_;
    if (is_bracketed)
      crf = (good + bad) / 2;
    else
      crf = is_good ? std::min(good + step, max_crf_) : std::max(bad - step, 0);
    step *= 2;
  }
  if (best) crf_ = good;
  return best;
}

Result<std::optional<FoundVideo>> VideoSearch::find(std::span<const idf::NdArray> images) {
  ENGRAM_ASSIGN_OR_RETURN(auto video, find_lossy(images));
  ENGRAM_ASSIGN_OR_RETURN(auto lossless, find_lossless(images));
  const bool is_lossless_less =
      lossless && (!video || lossless->bytes.size() < video->bytes.size());
  return is_lossless_less ? std::move(lossless) : std::move(video);
}

}  // namespace engram::training
