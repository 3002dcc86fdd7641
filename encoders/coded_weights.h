// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/h5/h5.h"

// Private to this room. Reads and writes the 8-bit weights and the backgrounds in a model file.

namespace engram::encoders {

/// Name and size of a matrix of weights, which is stored row by row.
struct MatrixShape {
  std::string name;
  size_t rows = 0;
  size_t columns = 0;
};

/// Name and size of the backgrounds of one image member.
struct ScenesShape {
  std::string name;
  size_t scenes = 0;
  LatentGrid shape;  ///< Of one background.
};

// Each function uses one dataset, in which a varint with its number of bytes precedes every part.
// `weights` and `pixels` hold all parts one after the other. Reading is safe on hostile files.
// Errors: kDataLoss, with the name of the damaged part.

Status write_matrices(h5::File& file, std::span<const MatrixShape> shapes,
                      std::span<const int8_t> weights);
Result<std::vector<int8_t>> read_matrices(const h5::File& file,
                                          std::span<const MatrixShape> shapes);

Status write_backgrounds(h5::File& file, std::span<const ScenesShape> shapes,
                         std::span<const uint8_t> pixels);
Result<std::vector<uint8_t>> read_backgrounds(const h5::File& file,
                                              std::span<const ScenesShape> shapes);

}  // namespace engram::encoders
