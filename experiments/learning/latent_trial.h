// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/core/status.h"

namespace engram::experiments {

/// Rows of latents, one after the other. Shape: [T, latents].
using LatentRows = std::vector<int32_t>;

/// What image_latents.py wrote: 32-bit integers of this machine. The number of rows, of recordings,
/// the first row of each; channels, height and width of both grids; then the rows.
struct LatentTrial {
  std::vector<encoders::LatentGrid> grids;
  std::vector<LatentRows> recordings;
  size_t rows = 0;     ///< Of all recordings.
  size_t latents = 0;  ///< Of a row.
};

/// Errors: kNotFound; kDataLoss where the file's size is not what it announces.
Result<LatentTrial> read_latent_trial(const std::filesystem::path& file);

/// All recordings in blocks of so many rows, each begun anew with a recording.
[[nodiscard]] std::vector<LatentRows> blocks_of(const LatentTrial& trial, size_t rows);

}  // namespace engram::experiments
