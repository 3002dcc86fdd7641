// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "encoders/tensor_plan.h"
#include "training/fit/stage_times.h"
#include "training/forms/entity_videos.h"

// Private to this room.

namespace engram::training {

/// The values of a chain: so many rows from the `chain`-th multiple of `chain_rows` on, or the
/// rest.
[[nodiscard]] std::span<const idf::SplitValue> chain_of(std::span<const idf::SplitValue> block,
                                                        size_t chain_rows, size_t chain);

/// Finds the videos of the chains of blocks, several at a time.
///
/// Chains of one wave learn nothing from each other, so the result is the same for any number of
/// threads.
/// Threading: one thread, which starts others for a wave.
class ChainVideos {
 public:
  using Block = std::span<const idf::SplitValue>;
  using Found = std::vector<VideoSearchResult>;  ///< Of a chain, per image member.
  /// Called between waves with the number of finished rows. An error ends the search.
  using Pause = std::function<Status(size_t rows)>;

  /// `plan` and `times`, which may be null, must outlive this object.
  ChainVideos(const encoders::TensorPlan& plan, size_t chain_rows,
              std::shared_ptr<EntityVideos> videos, int threads, StageTimes* times);

  /// Finds the videos of several blocks, for which of_block() must be called next and in this order
  /// (checked). `pause` gets the number of finished rows of all.
  /// Errors: kCancelled on `stop`; those of the codecs.
  Status find_ahead(const std::vector<Block>& blocks, const std::stop_token& stop,
                    const Pause& pause);

  /// The videos of the chains of a block, found ahead or now.
  /// Errors: as for find_ahead().
  Result<std::vector<Found>> of_block(Block block, const std::stop_token& stop, const Pause& pause);

  /// The video of an image member of a single chain, found now.
  /// Errors: as for find_ahead().
  Result<VideoSearchResult> of_chain(Block chain, size_t image, const std::stop_token& stop);

  /// Lossy encodes of each search; nothing where the video was known. One search per chain and
  /// image member.
  [[nodiscard]] const std::vector<std::optional<int>>& encodes() const { return encodes_; }

  /// What is known about the videos of the entity.
  [[nodiscard]] EntityVideos& known() { return *videos_; }

 private:
  [[nodiscard]] std::vector<Block> chains_of(Block block) const;
  Result<std::vector<Found>> find(const std::vector<Block>& chains, const std::stop_token& stop,
                                  const Pause& pause);
  /// Sets the lossy encodes that it took, unless the video is known.
  Result<VideoSearchResult> find(Block chain, size_t image, const std::stop_token& stop,
                                 std::optional<int>& encodes);

  const encoders::TensorPlan& plan_;
  size_t chain_rows_;
  std::shared_ptr<EntityVideos> videos_;
  int threads_;
  StageTimes* times_;
  std::vector<std::optional<int>> encodes_;
  std::deque<Found> ahead_;  ///< Of the chains of the next blocks.
};

}  // namespace engram::training
