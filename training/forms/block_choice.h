// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "encoders/deep_model.h"
#include "training/forms/representation.h"
#include "training/forms/video_search.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// What the error of images that a network decodes must be better than the bound by: elsewhere
/// some pixels may come out a grey level apart. Unit: dB.
inline constexpr double kDecodingMarginDb = 0.02;

/// Codes runs of snapshots as blocks, each image member in the form that takes fewest bytes and
/// keeps the bound: latents as the encoder makes them or refined, with residuals where they miss
/// it; video; or without loss.
///
/// Threading: one thread.
/// Source: docs/learning.md, section "What is stored".
class BlockChoice {
 public:
  /// The model outlives it. Needs a bound (checked) where others than latents may be kept.
  BlockChoice(encoders::DeepModel& model, const RepresentationOptions& options);

  /// Called between parts of the work with how many rows of the block are done; an error ends
  /// encoding with it.
  using Pause = std::function<Status(size_t rows)>;

  /// One latent per value: consecutive values of one recording, at most a block.
  /// Errors: kCancelled on `stop`; kInvalidArgument, also where no form keeps the bound.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values,
                                          const std::stop_token& stop = {},
                                          const Pause& pause = {});

  [[nodiscard]] encoders::StoredForms counts() const;

 private:
  /// A way to keep an image member of a chain.
  struct Candidate {
    encoders::ImageRows rows;
    uint64_t bytes = 0;
  };
  /// The least ways of its kinds to keep an image member of a chain within the bound; one at least.
  struct Choice {
    std::optional<Candidate> latents;  ///< With residuals where they need them.
    std::optional<Candidate> video;    ///< With loss or without.

    /// Of equals latents: they are reached sooner.
    [[nodiscard]] bool keeps_latents() const {
      return latents && (!video || latents->bytes <= video->bytes);
    }
    [[nodiscard]] Candidate& smallest() { return keeps_latents() ? *latents : *video; }
    [[nodiscard]] const Candidate& smallest() const { return keeps_latents() ? *latents : *video; }
  };
  using Choices = std::vector<Choice>;  ///< Per image member.
  /// Images [row][member].
  using Images = std::vector<std::vector<idf::NdArray>>;

  /// Rows as a query sees them: numbers as they are decoded.
  Result<encoders::LatentRows> seen(encoders::LatentRows rows, size_t count) const;
  Result<Images> decoded(const encoders::LatentRows& rows, size_t count);
  /// Mean squared errors [row][member]; infinite for depth, which nothing but what has no loss
  /// keeps within a bound of 8-bit images.
  Result<std::vector<std::vector<double>>> errors_of(std::span<const idf::SplitValue> values,
                                                     const Images& images) const;
  [[nodiscard]] const idf::NdArray& recorded(const idf::SplitValue& value, size_t image) const;

  [[nodiscard]] bool has_networks() const;
  /// Those of a chain.
  [[nodiscard]] std::span<const idf::SplitValue> rows_of(std::span<const idf::SplitValue> values,
                                                         size_t chain) const;

  /// Of a chain that pays for so many bytes of background.
  Status keep_latents(std::span<const idf::SplitValue> values, encoders::LatentRows& rows,
                      uint64_t background, const std::stop_token& stop);
  /// Of a whole block.
  Status keep_smallest(std::span<const idf::SplitValue> values,
                       std::vector<encoders::LatentRows>& chains, const std::stop_token& stop,
                       const Pause& pause);
  Result<Choices> choices_of(std::span<const idf::SplitValue> values,
                             const encoders::LatentRows& rows, const std::stop_token& stop);
  /// What the encoder made, and where it was tried, what became of it by refining: per member.
  Result<std::vector<std::vector<Candidate>>> latent_candidates(
      std::span<const idf::SplitValue> values, const encoders::LatentRows& rows,
      const std::stop_token& stop);
  /// The latents of a member, decoded to `images`, with the residuals that they need; nothing where
  /// these do not help.
  [[nodiscard]] std::optional<Candidate> corrected(std::span<const idf::SplitValue> values,
                                                   size_t image, const encoders::ImageRows& rows,
                                                   const Images& images) const;
  Result<Choice> choose(std::span<const idf::SplitValue> values, size_t image,
                        std::vector<Candidate> candidates);
  Status add_videos(std::span<const idf::SplitValue> values, size_t image,
                    std::vector<Candidate>& candidates);
  [[nodiscard]] int refine_steps(const std::vector<std::vector<double>>& errors) const;
  void count_kept(const Candidate& kept, size_t rows);

  encoders::DeepModel& model_;
  RepresentationOptions options_;
  double bound_db_;                    ///< Of decoded latents: with the margin of decoding.
  double max_mse_;                     ///< The same. Unit: grey levels squared.
  std::vector<VideoSearch> searches_;  ///< Per image member.
  encoders::StoredForms counts_;
  bool can_correct_all_ = true;  ///< So far latents with residuals kept every row.
};

}  // namespace engram::training
