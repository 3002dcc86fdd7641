// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "encoders/packed_video.h"
#include "ltm/idf/ndarray.h"
#include "training/forms/video_history.h"

namespace engram::training {

/// A small video of some images in which every image keeps a bound.
struct FoundVideo {
  std::vector<std::byte> bytes;
  /// Code of the residuals of those images that would miss the bound (video_correction.h); empty if
  /// none would.
  std::vector<std::byte> residual;
  encoders::ImageForm form = encoders::ImageForm::kPackedAv1;
  double quality = 0;       ///< Its crf; 0 if lossless.
  std::vector<double> mse;  ///< Per image, corrected. Unit: grey levels squared.

  [[nodiscard]] size_t size() const { return bytes.size() + residual.size(); }
};

/// The result of the search in one chain.
struct VideoSearchResult {
  std::optional<FoundVideo> lossy;     ///< Empty if no quality keeps the bound.
  std::optional<FoundVideo> lossless;  ///< Empty also if it was not tried.
  std::vector<VideoTrial> trials;      ///< Of the lossy codec, in their order.
  /// Whether the encoder made another key frame of a reference than it made before.
  bool has_other_key_frame = false;

  /// The smaller one, or null.
  [[nodiscard]] FoundVideo* smallest();
};

struct VideoSearchOptions {
  std::string codec = "av1";  ///< Or "h265", "h264".
  /// What follows crf in the codec's text, as in "av1:crf=32,effort=7".
  std::string settings = "effort=7";
  double bound_db = 0;  ///< Every image has at least this PSNR.
  /// The search ends at a quality that is at most so much above the bound, or whose residuals take
  /// no more bytes than such a quality would. With 0 it finds the smallest video, which takes at
  /// least three encodes.
  double tolerance_db = 0;
};

/// Searches for the quality that a group codec needs to keep a bound. Each search starts at what
/// chains before it taught, because consecutive runs of images need similar qualities.
///
/// Threading: search() may run in several threads beside each other, but not beside the others.
/// Source: docs/learning_methods.md, section "What is stored".
class VideoSearch {
 public:
  explicit VideoSearch(VideoSearchOptions options);

  /// From now on videos begin from one of these references where their first image is within its
  /// reach.
  void use_references(std::vector<encoders::OpenReference> references);

  /// The reference of this name, or null.
  [[nodiscard]] const encoders::VideoReference* find_reference(uint64_t hash) const;

  /// Finds the lossy video, and the lossless one where it could be smaller. It learns nothing, so
  /// that the results of several chains do not depend on their order.
  /// Errors: kCancelled on `stop`, which is looked at before each encode; the errors of the codecs.
  Result<VideoSearchResult> search(std::span<const idf::NdArray> images,
                                   const std::stop_token& stop = {}) const;

  /// Learns from a search, for those that follow.
  void learn(const VideoSearchResult& result);

  /// Searches, learns, and returns the smaller video, or nothing if no installed codec accepts such
  /// images.
  /// Errors: the errors of the codecs.
  Result<std::optional<FoundVideo>> find(std::span<const idf::NdArray> images);

  [[nodiscard]] const VideoSearchOptions& options() const { return options_; }
  /// Begins with what an earlier job learned.
  void go_on_from(const VideoHistory::Line& line) { history_.go_on_from(line); }
  [[nodiscard]] const VideoHistory& history() const { return history_; }

 private:
  struct Encoded {
    FoundVideo video;
    std::vector<idf::NdArray> decoded;
  };
  /// Images, and what their video begins from; null for a key frame of its own.
  struct Chain {
    std::span<const idf::NdArray> images;
    const encoders::OpenReference* from = nullptr;
  };
  [[nodiscard]] const encoders::OpenReference* nearest(const idf::NdArray& image) const;
  Result<Encoded> encode(std::span<const idf::NdArray> images, const std::string& codec) const;
  Result<std::optional<Encoded>> encode_from_reference(const Chain& chain, int crf) const;
  Result<Encoded> encode(const Chain& chain, int crf, VideoSearchResult& result) const;
  Result<std::optional<FoundVideo>> corrected(std::span<const idf::NdArray> images,
                                              Encoded encoded) const;
  Status search_lossy(const Chain& chain, const std::stop_token& stop,
                      VideoSearchResult& result) const;
  Status search_beside(const Chain& chain, const std::stop_token& stop,
                       VideoSearchResult& result) const;
  Status search_lossless(std::span<const idf::NdArray> images, VideoSearchResult& result) const;
  [[nodiscard]] bool is_worth_it(const FoundVideo& corrected, double worst) const;
  [[nodiscard]] bool may_lossless_win(const VideoSearchResult& result, size_t images) const;

  using References = std::vector<encoders::OpenReference>;

  VideoSearchOptions options_;
  std::shared_ptr<const References> references_ = std::make_shared<References>();
  int max_crf_;
  double near_db_;  ///< A video that is so near to its bound ends the first part of the search.
  VideoHistory history_;
  /// How many times larger the lossless video of an image is than the last lossy one; 0 if unknown.
  double lossless_ratio_ = 0;
  double lossless_bytes_ = 0;  ///< Of an image, when it was tried last.
  size_t untried_ = 0;         ///< Chains since the lossless codec was tried.
};

}  // namespace engram::training
