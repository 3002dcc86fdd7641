// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "encoders/latent_chain.h"
#include "encoders/packed_video.h"
#include "ltm/core/time.h"
#include "training/forms/video_search.h"

namespace engram::training {

/// An image of an entity, as a chain may begin with it.
struct ReferenceSample {
  Time time;
  idf::NdArray image;
};

struct ReferenceChoiceOptions {
  double chains = 0;  ///< Number of chains that will be coded.
  int crf = 0;        ///< Quality that most chains need.
  /// What follows crf in the codec's text, as in VideoSearchOptions.
  std::string settings;
  int max_tried = 4;  ///< Candidates that are tried.
};

/// Chooses pictures from which AV1 videos of an entity begin instead of with key frames of their
/// own, and how far each reaches. `known` are references of an earlier model.
///
/// Some evenly spaced images stand for the first images of all chains. What each takes as a key
/// frame, and what it takes from a candidate, is measured by coding it. A candidate is chosen if it
/// saves more in all chains than it takes itself. The first candidate is the sample that has the
/// most in common with all, the next ones have the most in common with those that are served worst.
/// Errors: kCancelled on `stop`; those of the codec.
/// Source: docs/learning_methods.md, section "References".
Result<std::vector<encoders::OpenReference>> choose_references(
    std::span<const ReferenceSample> samples, std::vector<encoders::OpenReference> known,
    const ReferenceChoiceOptions& options, const std::stop_token& stop);

/// Opens the references of an image member. One that does not decode is left out with a warning:
/// videos get key frames of their own then.
[[nodiscard]] std::vector<encoders::OpenReference> open_references(
    const encoders::LatentChainCodec& chain, size_t member);

}  // namespace engram::training
