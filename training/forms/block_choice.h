// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "encoders/deep_model.h"
#include "training/fit/stage_times.h"
#include "training/forms/chain_videos.h"
#include "training/forms/representation.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Margin above the bound for images that a network decodes, because on another machine some pixels
/// may differ by a grey level. Unit: dB.
inline constexpr double kDecodingMarginDb = 0.02;

/// Codes runs of snapshots as blocks, each image member in the smallest form that keeps the bound:
/// latents from the encoder or refined ones, with residuals if they miss it; video; or lossless.
///
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "What is stored".
class BlockChoice {
 public:
  /// The model must outlive this object. A bound is needed (checked) unless only latents are kept.
  /// `times` counts the time of encoding; it may be null, else it must outlive this object, too.
  BlockChoice(encoders::DeepModel& model, const RepresentationOptions& options,
              StageTimes* times = nullptr);

  /// Called between parts of the work with the number of finished rows of the block. An error ends
  /// encoding and is returned.
  using Pause = ChainVideos::Pause;

  /// Codes consecutive values of one recording, at most one block, and returns one latent per
  /// value.
  /// Errors: kCancelled on `stop`; kInvalidArgument, also if no form keeps the bound.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values,
                                          const std::stop_token& stop = {},
                                          const Pause& pause = {});

  /// Whether find_ahead() has something to find.
  [[nodiscard]] bool finds_videos() const;

  /// Finds the videos of several blocks, for which encode() must be called next and in this order
  /// (checked). Chains are what is worked on at the same time, and blocks of short recordings have
  /// one or two. `pause` gets the number of finished rows of all.
  /// Errors: as for encode().
  Status find_ahead(std::span<const std::span<const idf::Data>> blocks,
                    const std::stop_token& stop = {}, const Pause& pause = {});

  [[nodiscard]] encoders::StoredForms counts() const;

  /// Lossy encodes of each search for a video; nothing where the video was known. One search per
  /// chain and image member.
  [[nodiscard]] const std::vector<std::optional<int>>& video_encodes() const {
    return videos_.encodes();
  }

  /// What is known about the videos of the entity.
  [[nodiscard]] EntityVideos& videos() { return videos_.known(); }

 private:
  /// One form of an image member of a chain, with its size.
  struct Candidate {
    encoders::ImageRows rows;
    uint64_t bytes = 0;
  };
  /// The smallest candidates of each kind that keep an image member of a chain within the bound.
  /// There is at least one.
  struct Choice {
    std::optional<Candidate> latents;  ///< With residuals if needed.
    std::optional<Candidate> video;    ///< Lossy or lossless.

    /// Latents win a tie, because they are faster to read.
    [[nodiscard]] bool keeps_latents() const {
      return latents && (!video || latents->bytes <= video->bytes);
    }
    [[nodiscard]] Candidate& smallest() { return keeps_latents() ? *latents : *video; }
    [[nodiscard]] const Candidate& smallest() const { return keeps_latents() ? *latents : *video; }
  };
  using Choices = std::vector<Choice>;  ///< Per image member.
  using Videos = ChainVideos::Found;
  using Values = std::vector<idf::SplitValue>;
  /// Images [row][member].
  using Images = std::vector<std::vector<idf::NdArray>>;

  /// Returns rows as a query sees them, with decoded numbers.
  Result<encoders::LatentRows> seen(encoders::LatentRows rows, size_t count) const;
  Result<Images> decoded(const encoders::LatentRows& rows, size_t count);
  /// Mean squared errors [row][member]; infinite for depth, which only lossless forms keep, since
  /// the bound is for 8-bit images.
  Result<std::vector<std::vector<double>>> errors_of(std::span<const idf::SplitValue> values,
                                                     const Images& images) const;
  [[nodiscard]] const idf::NdArray& recorded(const idf::SplitValue& value, size_t image) const;

  [[nodiscard]] bool has_networks() const;

  /// Keeps a chain as latents. `background` is the size of the background that the chain pays for.
  Status keep_latents(std::span<const idf::SplitValue> values, encoders::LatentRows& rows,
                      uint64_t background, const std::stop_token& stop);
  /// Keeps all chains of a block in their smallest forms.
  Status keep_smallest(std::span<const idf::SplitValue> values,
                       std::vector<encoders::LatentRows>& chains, const std::stop_token& stop,
                       const Pause& pause);
  /// `videos` is null if they are needed only where latents fail.
  Result<Choices> choices_of(std::span<const idf::SplitValue> values,
                             const encoders::LatentRows& rows, Videos* videos,
                             const std::stop_token& stop);
  /// Returns per member the latents from the encoder and, if refinement was tried, the refined
  /// ones.
  Result<std::vector<std::vector<Candidate>>> latent_candidates(
      std::span<const idf::SplitValue> values, const encoders::LatentRows& rows,
      const std::stop_token& stop);
  /// Returns the latents of a member, which decode to `images`, with the residuals that they need;
  /// nothing if no residual keeps the bound.
  [[nodiscard]] std::optional<Candidate> corrected(std::span<const idf::SplitValue> values,
                                                   size_t image, const encoders::ImageRows& rows,
                                                   const Images& images) const;
  Result<Choice> choose(size_t image, std::vector<Candidate> candidates,
                        std::optional<VideoSearchResult> video);
  void add_videos(VideoSearchResult video, std::vector<Candidate>& candidates);
  Result<Values> split(std::span<const idf::Data> values) const;
  [[nodiscard]] int refine_steps(const std::vector<std::vector<double>>& errors) const;
  void count_kept(const Candidate& kept, size_t rows);

  encoders::DeepModel& model_;
  RepresentationOptions options_;
  StageTimes* times_;
  /// Bound of decoded latents, including the margin of decoding.
  double bound_db_;
  double max_mse_;  ///< The same as an error. Unit: grey levels squared.
  ChainVideos videos_;
  encoders::StoredForms counts_;
  int64_t lossless_tried_rows_ = 0;
  bool can_correct_all_ = true;  ///< Whether latents with residuals kept every row so far.
};

}  // namespace engram::training
