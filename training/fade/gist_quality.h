// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "encoders/gist_video.h"
#include "ltm/store/latent.h"

// Private to this room.

namespace engram::training {

/// Bytes that the gist of an image may take, in the mean of a block. Still scenes look better
/// within them than moving ones.
inline constexpr double kMaxGistBytes = 20;

/// Finds how much of images a gist may keep within kMaxGistBytes. It begins where the block before
/// ended, because blocks of one camera are alike.
///
/// Threading: one thread.
class GistQuality {
 public:
  using Encode =
      std::function<Result<std::vector<ltm::Latent>>(const encoders::GistOptions& options)>;

  /// The best gist of `images` images within the bytes, or the smallest one. `encode` is called
  /// with one quality after the other.
  /// Errors: those of `encode`.
  Result<std::vector<ltm::Latent>> find(size_t images, const Encode& encode);

 private:
  std::optional<size_t> level_;  ///< Of the block before: an index into the levels of the source.
};

}  // namespace engram::training
