// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/core/status.h"

namespace engram::encoders {

/// The initial state of the coder of latents. It is learned from recordings and stored in a model.
///
/// Source: docs/learning_methods.md, section "Sequences of latents".
class LatentModel {
 public:
  /// Makes an untrained model. `grids` are ordered from the coarsest to the finest; there must be
  /// at least one, and none may be empty (checked).
  explicit LatentModel(std::vector<LatentGrid> grids);

  /// Learns from sequences of whole rows.
  /// Shape: each [T, latents()].
  static LatentModel train(std::vector<LatentGrid> grids,
                           std::span<const std::vector<int32_t>> sequences);

  /// Compressed, with a checksum that also covers identity().
  [[nodiscard]] std::vector<std::byte> to_bytes() const;

  /// Errors: kDataLoss if the bytes are no model of these grids.
  static Result<LatentModel> from_bytes(std::span<const std::byte> bytes,
                                        std::vector<LatentGrid> grids);

  [[nodiscard]] const std::vector<LatentGrid>& grids() const { return grids_; }

  /// A hash of the sizes of the grids and the number of contexts, by which models of other grids
  /// are refused.
  [[nodiscard]] uint64_t identity() const;

  /// Number of latents in one row, over all grids.
  [[nodiscard]] size_t latents() const;

  friend bool operator==(const LatentModel&, const LatentModel&) = default;

 private:
  friend class LatentRowCoder;

  std::vector<LatentGrid> grids_;
  std::vector<int8_t> starts_;    ///< Log odds per context and node, see latent_row_coder.h.
  std::vector<int16_t> weights_;  ///< Of the mixers.
};

/// Codes the integer latents of consecutive snapshots as one block. Contexts are previous rows and
/// known neighbours. It uses integer arithmetic only, so every machine decodes the same latents.
///
/// A block decodes alone, from its first row on. It ends with a checksum of 32 bits.
/// Shape: [T, latents()], where a row holds all grids in order, each [channels, height, width].
/// Threading: immutable, const-parallel.
/// Source: docs/learning_methods.md, section "Sequences of latents".
class LatentSequenceCodec {
 public:
  explicit LatentSequenceCodec(LatentModel model) : model_(std::move(model)) {}

  [[nodiscard]] const LatentModel& model() const { return model_; }

  /// `latents` must hold whole rows (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const int32_t> latents) const;

  /// Decodes the first `wanted` of the `rows` rows of a block; `wanted` must be at most `rows`
  /// (checked). It is safe on hostile bytes: the checksum covers `rows`.
  /// Complexity: O(wanted), plus the checksum of the whole block and the copy of the model's
  /// starts.
  /// Errors: kDataLoss if the checksum does not fit.
  Result<std::vector<int32_t>> decode(std::span<const std::byte> block, size_t rows,
                                      size_t wanted) const;
  Result<std::vector<int32_t>> decode(std::span<const std::byte> block, size_t rows) const {
    return decode(block, rows, rows);
  }

  /// The ideal code length of each row of a sequence, in bits.
  [[nodiscard]] std::vector<double> cost_bits(std::span<const int32_t> latents) const;

 private:
  LatentModel model_;
};

}  // namespace engram::encoders
