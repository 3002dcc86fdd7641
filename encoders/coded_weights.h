// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/h5/h5.h"

// Private to this room: how the weights of 8 bits and the backgrounds of a model lie in its file.

namespace engram::encoders {

/// A matrix of weights, row by row.
struct MatrixShape {
  std::string name;
  size_t rows = 0;
  size_t columns = 0;
};

/// The backgrounds of one image member.
struct ScenesShape {
  std::string name;
  size_t scenes = 0;
  LatentGrid shape;  ///< Of one of them.
};

// One dataset each: every part after a varint of its bytes. Reading is safe on hostile files.
// `weights` and `pixels` hold all parts one after the other.
// Errors: kDataLoss naming the part.

Status write_matrices(h5::File& file, std::span<const MatrixShape> shapes,
                      std::span<const int8_t> weights);
Result<std::vector<int8_t>> read_matrices(const h5::File& file,
                                          std::span<const MatrixShape> shapes);

Status write_backgrounds(h5::File& file, std::span<const ScenesShape> shapes,
                         std::span<const uint8_t> pixels);
Result<std::vector<uint8_t>> read_backgrounds(const h5::File& file,
                                              std::span<const ScenesShape> shapes);

}  // namespace engram::encoders
