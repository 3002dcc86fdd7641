// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ltm/core/sequences.h"

namespace engram::training {

/// Draws chunks of consecutive rows to train on. Expensive rows are drawn more often and get a
/// smaller weight, so that the mean loss stays that of all rows. Rows that the previous model has
/// latents of are trained on too, but count for at most 30 % of the mean (replay).
///
/// It uses LibTorch's random generator.
/// Threading: one thread.
/// Source: docs/learning_methods.md, sections "The image autoencoder" and "Later nights".
class RowSampler {
 public:
  /// The last row of a chunk, and the factor of its cost.
  struct Draw {
    int64_t last = 0;
    double weight = 1;
  };

  /// `first_held_out` is the first held-out row of each sequence; a batch has only held-out rows or
  /// only others. `is_known` is per row; if it is empty, no row is known.
  RowSampler(std::span<const Sequence> sequences, std::span<const size_t> first_held_out,
             const std::vector<bool>& is_known = {});

  /// Draws the last rows of `chunks` chunks. All are held out or none is, as the first one.
  [[nodiscard]] std::vector<Draw> draw(int64_t chunks);

  /// Stores the cost of a row that was drawn.
  void told(int64_t row, double cost);

  /// Rows now hold other values, whose cost is not known.
  void forget(const Sequence& rows);

  [[nodiscard]] bool is_held_out(int64_t row) const;
  /// First row of the sequence that contains `row`.
  [[nodiscard]] int64_t first_of(int64_t row) const;

  /// All numbers that change, for checkpoints. The pointers are valid as long as this object.
  [[nodiscard]] std::vector<double*> state();

 private:
  [[nodiscard]] std::vector<double> probabilities() const;

  std::vector<double> shares_;   ///< Share of the mean, per row.
  std::vector<double> costs_;    ///< Smoothed; 0 if never drawn.
  std::vector<int64_t> firsts_;  ///< Per row.
  std::vector<bool> is_held_out_;
};

}  // namespace engram::training
