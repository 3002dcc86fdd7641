// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::encoders {

/// What a gist may lose in time.
struct GistRowOptions {
  /// A row is kept if it raises the sum of the PSNR of all rows by this. Unit: dB.
  double gain_db = 3;
  /// Squared error that coding leaves in a kept row anyway. Unit: grey levels, squared.
  double coding_mse = 150;
  /// Maximum distance of kept rows.
  size_t max_gap = 24;
};

/// Chooses the rows from which a linear interpolation in time gives the others best: the sum of
/// the PSNR of all rows, less a price for each kept row, is as large as it can be. Still moments
/// have hardly any kept rows and fast ones have many. The first and the last row are kept.
///
/// Shape: each row [values], of one size (checked); at least one row.
/// Complexity: rows * max_gap * (values + max_gap).
/// Threading: stateless.
std::vector<size_t> choose_gist_rows(std::span<const std::vector<uint8_t>> rows,
                                     const GistRowOptions& options);

}  // namespace engram::encoders
