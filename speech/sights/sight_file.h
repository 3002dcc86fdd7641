// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"
#include "speech/sights/latent_images.h"
#include "speech/sights/sight_layers.h"
#include "speech/sights/sight_words.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// A network with what its numbers mean.
struct SavedSights {
  SightWords words;
  uint64_t model = 0;  ///< The checksum of the model whose latents it reads.
  CellGrid grid;
  double min_probability = 0.5;  ///< From which on a thing is told to be in sight.
  int64_t images = 0;            ///< That it was trained with.
  SightLayers layers{nullptr};

  [[nodiscard]] SightShape shape() const;
};

/// Writes a whole file under another name and publishes it in one step. Errors: kUnavailable.
Status save_sights(const SavedSights& sights, const std::filesystem::path& path);

/// It is safe on hostile files.
/// Errors: kNotFound; kDataLoss if the file is damaged; kFailedPrecondition if another version of
/// this program wrote it.
Result<SavedSights> read_sights(const std::filesystem::path& path);

}  // namespace engram::speech
