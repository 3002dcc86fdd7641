// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::speech {

/// How a network learns to see things in latents.
struct LearnSightsOptions {
  /// How long it trains, once images are read.
  Duration budget = std::chrono::minutes(10);
  int threads = 1;
  int64_t batch = 32;  ///< Images of a step.
  double learning_rate = 2e-3;
  uint64_t seed = 1;
  /// Each image is learned from in so many changed copies, too: its things in other colours, in
  /// other light, mirrored. Without, the network takes colours for kinds. Each costs as much as
  /// encoding the image, and 20 kB of memory at 128 x 128 pixels.
  int copies = 2;

  [[nodiscard]] Status validate() const;
};

struct SightsReport {
  size_t images = 0;
  size_t copies = 0;
  size_t recordings = 0;
  size_t held_out = 0;  ///< Of the recordings; they take no part in training.
  int64_t steps = 0;
  int64_t parameters = 0;
  double seconds = 0;
  double loss = 0;  ///< The mean of the last hundred steps.
  /// Of the recordings that are held out: from which probability on a thing is told to be in sight,
  /// the share of what is in sight that is told, and the share of what is told that is right.
  double min_probability = 0;
  double found = 0;
  double found_rightly = 0;
  /// Of things that are in sight and told so: the place, and the colour.
  double place_right = 0;
  double colour_right = 0;
};

/// Learns to see things in the latents that nights made of images, from memories that also tell
/// where things and cameras were, and writes a network to `file`. All images have to be latents of
/// one model; those of later models cannot be read with it. What images show is learned from
/// changed copies as well, which needs the images themselves; what is learned reads latents alone.
/// Errors: kInvalidArgument if options do not validate, for several models, or for fewer than two
/// recordings (a pause of a minute divides them); kNotFound where nothing can be learned from;
/// kCancelled; kDataLoss; kUnavailable.
/// Threading: one thread that calls; `threads` that compute.
/// Source: docs/verbalisation.md, section "What images show".
Result<SightsReport> learn_sights(const std::vector<std::filesystem::path>& stores,
                                  const LearnSightsOptions& options,
                                  const std::filesystem::path& file, const ProgressSink& progress,
                                  const std::stop_token& stop);

}  // namespace engram::speech
