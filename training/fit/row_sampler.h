// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "training/fit/sequences.h"

namespace engram::training {

/// Chunks of consecutive rows to train on: those that cost much are drawn more often, and count
/// less each time, so that the mean is that of all rows. Rows that a model knows already are told
/// again, but are at most 30 % of it (replay).
///
/// Uses LibTorch's random generator. Threading: one thread.
/// Source: docs/learning.md, section "The image autoencoder".
class RowSampler {
 public:
  /// The last row of a chunk, and what its cost is to be multiplied by.
  struct Draw {
    int64_t last = 0;
    double weight = 1;
  };

  /// `first_held_out` per sequence: rows from there on are never in one batch with those before.
  /// `is_known` per row; empty: none is.
  RowSampler(std::span<const Sequence> sequences, std::span<const size_t> first_held_out,
             const std::vector<bool>& is_known = {});

  /// The ends of some chunks, all of the same kind: the first one decides.
  [[nodiscard]] std::vector<Draw> draw(int64_t chunks);

  /// What a row cost when it was drawn.
  void told(int64_t row, double cost);

  [[nodiscard]] bool is_held_out(int64_t row) const;
  /// The first row of the sequence of a row.
  [[nodiscard]] int64_t first_of(int64_t row) const;

  /// Everything that changes, for checkpoints; valid as long as this.
  [[nodiscard]] std::vector<double*> state();

 private:
  [[nodiscard]] std::vector<double> probabilities() const;

  std::vector<double> shares_;   ///< Of the mean, per row.
  std::vector<double> costs_;    ///< Smoothed; 0 where never told.
  std::vector<int64_t> firsts_;  ///< Per row.
  std::vector<bool> is_held_out_;
};

}  // namespace engram::training
