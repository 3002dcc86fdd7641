// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/core/status.h"

namespace engram::experiments {

/// Rows of latents, concatenated. Shape: [T, latents].
using LatentRows = std::vector<int32_t>;

/// The output of image_latents.py, in 32-bit integers of this machine: the number of rows, the
/// number of recordings, the first row of each; channels, height and width of both grids; the rows.
struct LatentTrial {
  std::vector<encoders::LatentGrid> grids;
  std::vector<LatentRows> recordings;
  size_t rows = 0;     ///< In all recordings.
  size_t latents = 0;  ///< In a row.
};

/// Errors: kNotFound; kDataLoss if the size of the file does not match its header.
Result<LatentTrial> read_latent_trial(const std::filesystem::path& file);

/// Splits all recordings into blocks of `rows` rows. No block spans two recordings.
[[nodiscard]] std::vector<LatentRows> blocks_of(const LatentTrial& trial, size_t rows);

}  // namespace engram::experiments
