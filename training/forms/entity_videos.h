// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "training/forms/video_search.h"

namespace engram::training {

/// What a job found out about an entity's images as video: how quality follows from crf, and the
/// videos themselves. An entity may be encoded several times, as with networks and without, and
/// what was encoded the night before is in the store: each video is searched for once.
///
/// Threading: find() and add() in any thread; searches() as VideoSearch.
class EntityVideos {
 public:
  /// `members` is the number of image members.
  EntityVideos(size_t members, const VideoSearchOptions& options);
  ~EntityVideos();

  /// Knows how quality follows from crf, but no video.
  [[nodiscard]] std::shared_ptr<EntityVideos> without_videos() const;

  [[nodiscard]] size_t members() const { return searches_.size(); }
  [[nodiscard]] VideoSearch& search_of(size_t member) { return searches_[member]; }

  /// What was found for these images of a member, which are recognised by a hash of 64 bits of
  /// their pixels; nothing if it begins from a reference that is not in use.
  [[nodiscard]] std::optional<VideoSearchResult> find(size_t member,
                                                      std::span<const idf::NdArray> images) const;

  /// Keeps what was found for these images, if it is a video and within 256 MiB of all.
  void add(std::span<const idf::NdArray> images, const VideoSearchResult& found);

  /// Keeps a video that the store holds of these images, with its residuals, if it keeps the bound.
  /// It is decoded for that. The caller knows that it was not made for a much higher bound.
  /// Errors: those of decoding.
  Status add_stored(size_t member, std::span<const idf::NdArray> images, encoders::ImageForm form,
                    std::span<const std::byte> bytes, std::span<const std::byte> residual);

  /// Number of videos that find() returned.
  [[nodiscard]] uint64_t reused() const;

 private:
  struct Found;

  std::vector<VideoSearch> searches_;
  std::unique_ptr<Found> found_;
};

}  // namespace engram::training
