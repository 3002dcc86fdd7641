// SPDX-License-Identifier: Apache-2.0
#include "training/forms/video_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ltm/codec/group_codec.h"
#include "ltm/codec/packed_value.h"
#include "training/forms/video_correction.h"
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
/// A search for the smallest video comes within this tolerance, and then tries what is beside.
constexpr double kUsualToleranceDb = 0.5;
/// Residuals are tried where the worst image misses its bound by at most so much.
constexpr double kMaxCorrectedDb = 1.2;
/// From this number of encodes on a search halves what is left, because quality did not follow the
/// line that was expected.
constexpr size_t kMaxByLine = 4;
/// With a key that is better by more than this, key frames of their own took fewer bytes.
/// Source: experiments/learning/LOG.md, "references".
constexpr int kMaxAboveKey = 10;

double worst_db(const FoundVideo& video) {
  double worst = kLargestPsnrDb;
  for (const double mse : video.mse) worst = std::min(worst, psnr_db(mse));
  return worst;
}

Result<std::vector<double>> errors_of(std::span<const idf::NdArray> images,
                                      std::span<const idf::NdArray> decoded) {
  std::vector<double> errors;
  for (size_t i = 0; i < images.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(errors.emplace_back(), image_mse(images[i], decoded[i]));
  }
  return errors;
}

void keep_smaller(FoundVideo video, VideoSearchResult& result) {
  if (!result.lossy || video.size() < result.lossy->size()) result.lossy = std::move(video);
}

}  // namespace

FoundVideo* VideoSearchResult::smallest() {
  if (lossless && (!lossy || lossless->size() < lossy->size())) return &*lossless;
  return lossy ? &*lossy : nullptr;
}

VideoSearch::VideoSearch(VideoSearchOptions options)
    : options_(std::move(options)),
      max_crf_(options_.codec == "av1" ? 63 : 51),
      near_db_(options_.tolerance_db > 0 ? options_.tolerance_db : kUsualToleranceDb),
      history_(options_.codec == "av1" ? kSlopeOfAv1 : kSlopeOfOthers) {}

Result<VideoSearch::Encoded> VideoSearch::encode(std::span<const idf::NdArray> images,
                                                 const std::string& codec) const {
  ENGRAM_ASSIGN_OR_RETURN(const auto coder, ltm::make_group_codec(codec));
  Encoded encoded;
  FoundVideo& video = encoded.video;
  ENGRAM_ASSIGN_OR_RETURN(auto group, coder->encode(images));
  if (coder->is_lossless()) {
    video.mse.assign(images.size(), 0.0);
  } else {
    ENGRAM_ASSIGN_OR_RETURN(encoded.decoded, coder->decode(group, images.front().type(),
                                                           images.front().shape(), images.size()));
    ENGRAM_ASSIGN_OR_RETURN(video.mse, errors_of(images, encoded.decoded));
  }
  encoders::StoredVideo stored = encoders::to_stored_video(coder->name(), std::move(group));
  video.form = stored.form;
  video.bytes = std::move(stored.bytes);
  return encoded;
}

/// Nothing if the encoder makes another key frame of the reference now.
Result<std::optional<VideoSearch::Encoded>> VideoSearch::encode_from_reference(const Chain& chain,
                                                                               int crf) const {
  std::optional<Encoded> encoded;
  const auto& images = chain.images;
  ENGRAM_ASSIGN_OR_RETURN(auto packed,
                          encoders::encode_from(*chain.from, images, crf, options_.settings));
  if (!packed) return encoded;
  encoded.emplace();
  encoded->video.bytes = *std::move(packed);
  ENGRAM_ASSIGN_OR_RETURN(
      encoded->decoded,
      encoders::unpack_video(encoded->video.bytes, {images.front().type(), images.front().shape()},
                             images.size(), images.size(), {&chain.from->reference, 1}));
  ENGRAM_ASSIGN_OR_RETURN(encoded->video.mse, errors_of(images, encoded->decoded));
  return encoded;
}

void VideoSearch::use_references(std::vector<encoders::OpenReference> references) {
  references_ = std::make_shared<const References>(std::move(references));
}

const encoders::VideoReference* VideoSearch::find_reference(uint64_t hash) const {
  for (const encoders::OpenReference& one : *references_)
    if (one.reference.hash() == hash) return &one.reference;
  return nullptr;
}

/// The reference that has the most in common with the first image of a chain, if that is enough.
const encoders::OpenReference* VideoSearch::nearest(const idf::NdArray& image) const {
  const encoders::OpenReference* best = nullptr;
  double distance = 0;
  for (const encoders::OpenReference& one : *references_) {
    const double found = encoders::reference_distance(one.picture, image);
    if (found > one.reference.reach || (best != nullptr && found >= distance)) continue;
    best = &one;
    distance = found;
  }
  return best;
}

/// Encodes with the lossy codec and adds the trial to `result`.
Result<VideoSearch::Encoded> VideoSearch::encode(const Chain& chain, int crf,
                                                 VideoSearchResult& result) const {
  // The key frame of a reference is the best picture of its videos. Far above it they would pay for
  // a quality that nobody asked for.
  const bool has_reference = chain.from != nullptr && crf > chain.from->reference.key &&
                             crf <= chain.from->reference.key + kMaxAboveKey &&
                             chain.images.size() < ltm::kMaxGroupImages;
  std::optional<Encoded> from_reference;
  if (has_reference && !result.has_other_key_frame) {
    ENGRAM_ASSIGN_OR_RETURN(from_reference, encode_from_reference(chain, crf));
    result.has_other_key_frame = !from_reference;
  }
  if (!from_reference) {
    ENGRAM_ASSIGN_OR_RETURN(
        from_reference,
        encode(chain.images, fmt::format("{}:crf={},{}", options_.codec, crf, options_.settings)));
  }
  Encoded encoded = *std::move(from_reference);
  encoded.video.quality = crf;
  result.trials.push_back({crf, worst_db(encoded.video), encoded.video.bytes.size()});
  return encoded;
}

/// The video with residuals of the images that miss the bound, if any, or nothing if they miss it
/// by too much.
Result<std::optional<FoundVideo>> VideoSearch::corrected(std::span<const idf::NdArray> images,
                                                         Encoded encoded) const {
  std::optional<FoundVideo> corrected;
  const double missed_db = options_.bound_db - worst_db(encoded.video);
  if (missed_db <= 0) return std::optional(std::move(encoded.video));
  if (missed_db > kMaxCorrectedDb) return corrected;
  ENGRAM_ASSIGN_OR_RETURN(auto correction,
                          correct_video(images, encoded.decoded, options_.bound_db));
  if (!correction) return corrected;
  corrected = std::move(encoded.video);
  corrected->residual = std::move(correction->residual);
  corrected->mse = std::move(correction->mse);
  return corrected;
}

/// Goes by the line that earlier chains taught, then by that of this chain's trials, and halves
/// what is left if neither leads there soon.
Status VideoSearch::search_lossy(const Chain& chain, const std::stop_token& stop,
                                 VideoSearchResult& result) const {
  const auto& images = chain.images;
  const auto coder = ltm::make_group_codec(options_.codec);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape())) return {};
  int good = -1;           // The largest crf that is known to keep the bound.
  int bad = max_crf_ + 1;  // The smallest crf that is known to miss it.
  double spare = std::numeric_limits<double>::infinity();  // Of the best video, above the bound.
  int crf = history_.is_empty() ? kFirstCrf : history_.first_guess(options_.bound_db, near_db_);
  while (bad - good > 1) {
    if (stop.stop_requested()) return cancelled("the search for a video was stopped");
    crf = std::clamp(crf, good + 1, bad - 1);
    ENGRAM_ASSIGN_OR_RETURN(Encoded encoded, encode(chain, crf, result));
    const double worst = result.trials.back().worst_db;
    const bool is_good = worst >= options_.bound_db;
    (is_good ? good : bad) = crf;
    if (is_good) {
      keep_smaller(std::move(encoded.video), result);
      spare = worst - options_.bound_db;
    } else {
      ENGRAM_ASSIGN_OR_RETURN(auto video, corrected(images, std::move(encoded)));
      const bool is_enough = video && is_worth_it(*video, worst);
      if (video) keep_smaller(*std::move(video), result);
      if (is_enough) break;
    }
    if (spare <= near_db_ * (result.trials.size() > 1 ? kLaterTolerance : 1)) break;
    if (result.trials.size() >= kMaxByLine && good >= 0 && bad <= max_crf_) {
      crf = (good + bad) / 2;
      continue;
    }
    const double change = history_.change_to(options_.bound_db - near_db_ / 2, result.trials);
    // A step more each time, so that a flat line does not creep.
    const int min_step = static_cast<int>(result.trials.size());
    crf += is_good ? std::max(static_cast<int>(std::floor(change)), 1)
                   : std::min(static_cast<int>(std::floor(change)), -min_step);
  }
  return options_.tolerance_db > 0 ? Status() : search_beside(chain, stop, result);
}

/// Tries the qualities beside the best one, first worse and then better ones, as long as they take
/// fewer bytes with the residuals that they need.
Status VideoSearch::search_beside(const Chain& chain, const std::stop_token& stop,
                                  VideoSearchResult& result) const {
  for (const int step : {1, -1}) {
    while (result.lossy) {
      if (stop.stop_requested()) return cancelled("the search for a video was stopped");
      const int crf = static_cast<int>(result.lossy->quality) + step;
      if (crf < 0 || crf > max_crf_ ||
          std::ranges::find(result.trials, crf, &VideoTrial::crf) != result.trials.end())
        break;
      ENGRAM_ASSIGN_OR_RETURN(Encoded encoded, encode(chain, crf, result));
      ENGRAM_ASSIGN_OR_RETURN(auto video, corrected(chain.images, std::move(encoded)));
      if (!video || video->size() >= result.lossy->size()) break;
      result.lossy = std::move(video);
    }
  }
  return {};
}

/// Whether residuals take no more bytes than the better quality of another encode would, which ends
/// half a tolerance above the bound.
bool VideoSearch::is_worth_it(const FoundVideo& corrected, double worst) const {
  const double missed_db = options_.bound_db - worst + near_db_ / 2;
  const double more = std::exp(history_.line().bytes_per_db * missed_db) - 1;
  return static_cast<double>(corrected.residual.size()) <=
         more * static_cast<double>(corrected.bytes.size());
}

bool VideoSearch::may_lossless_win(const VideoSearchResult& result, size_t images) const {
  if (!result.lossy || lossless_ratio_ == 0 || lossless_ratio_ <= kHopeless) return true;
  if (untried_ >= kMaxUntried) return true;
  // Images that became as costly as the lossless ones were.
  const auto bytes = static_cast<double>(result.lossy->size());
  return bytes * kHopeless >= lossless_bytes_ * static_cast<double>(images);
}

Status VideoSearch::search_lossless(std::span<const idf::NdArray> images,
                                    VideoSearchResult& result) const {
  const auto coder = ltm::make_group_codec(kLossless);
  if (!coder.ok() || !(*coder)->accepts(images.front().type(), images.front().shape())) return {};
  if (!may_lossless_win(result, images.size())) return {};
  ENGRAM_ASSIGN_OR_RETURN(Encoded encoded, encode(images, std::string(kLossless)));
  result.lossless = std::move(encoded.video);
  return {};
}

Result<VideoSearchResult> VideoSearch::search(std::span<const idf::NdArray> images,
                                              const std::stop_token& stop) const {
  VideoSearchResult result;
  ENGRAM_RETURN_IF_ERROR(search_lossy({images, nearest(images.front())}, stop, result));
  ENGRAM_RETURN_IF_ERROR(search_lossless(images, result));
  return result;
}

void VideoSearch::learn(const VideoSearchResult& result) {
  if (result.has_other_key_frame) use_references({});
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
                    static_cast<double>(std::max<size_t>(result.lossy->size(), 1));
}

Result<std::optional<FoundVideo>> VideoSearch::find(std::span<const idf::NdArray> images) {
  ENGRAM_ASSIGN_OR_RETURN(VideoSearchResult result, search(images));
  learn(result);
  FoundVideo* smallest = result.smallest();
  if (smallest == nullptr) return std::optional<FoundVideo>();
  return std::optional(std::move(*smallest));
}

}  // namespace engram::training
