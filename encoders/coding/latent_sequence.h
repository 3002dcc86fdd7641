// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/core/status.h"

namespace engram::encoders {

/// What the first latents of a block are coded by: learned from a recording, stored in a model.
///
/// Source: docs/learning_methods.md, section "Sequences of latents".
class LatentModel {
 public:
  /// Knows nothing yet. `grids` from the coarsest to the finest; one at least, none of them empty
  /// (checked).
  explicit LatentModel(std::vector<LatentGrid> grids);

  /// Learns from sequences, each of whole rows: [T, latents()].
  static LatentModel train(std::vector<LatentGrid> grids,
                           std::span<const std::vector<int32_t>> sequences);

  /// Compressed, with a checksum that also covers identity().
  [[nodiscard]] std::vector<std::byte> to_bytes() const;

  /// Errors: kDataLoss where the bytes are no model of these grids.
  static Result<LatentModel> from_bytes(std::span<const std::byte> bytes,
                                        std::vector<LatentGrid> grids);

  [[nodiscard]] const std::vector<LatentGrid>& grids() const { return grids_; }

  /// Of the grids' sizes and the number of contexts: models of other grids have another one.
  [[nodiscard]] uint64_t identity() const;

  /// Latents of one row: of all grids, one after the other.
  [[nodiscard]] size_t latents() const;

  friend bool operator==(const LatentModel&, const LatentModel&) = default;

 private:
  friend class LatentRowCoder;

  std::vector<LatentGrid> grids_;
  std::vector<int8_t> starts_;    ///< Log odds per context and node, see latent_walk.h.
  std::vector<int16_t> weights_;  ///< Of the mixers.
};

/// Codes the integer latents of consecutive snapshots as one block, each by what those before it
/// and its neighbours tell. Integer arithmetic only: every machine reads the same.
///
/// A block decodes alone, from its first row on; it ends with a checksum of 32 bits.
/// Shape: [T, latents()], every row the grids one after the other, each [channels, height, width].
/// Threading: immutable, const-parallel.
/// Source: docs/learning_methods.md, section "Sequences of latents".
class LatentSequenceCodec {
 public:
  explicit LatentSequenceCodec(LatentModel model) : model_(std::move(model)) {}

  [[nodiscard]] const LatentModel& model() const { return model_; }

  /// `latents` hold whole rows (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const int32_t> latents) const;

  /// The first `wanted` of the `rows` of a block, at most all of them (checked). Safe on hostile
  /// bytes: `rows` is covered by the checksum.
  /// Complexity: O(wanted), behind the checksum of the whole block and the model's starts.
  /// Errors: kDataLoss where the checksum does not fit.
  Result<std::vector<int32_t>> decode(std::span<const std::byte> block, size_t rows,
                                      size_t wanted) const;
  Result<std::vector<int32_t>> decode(std::span<const std::byte> block, size_t rows) const {
    return decode(block, rows, rows);
  }

  /// What each row of a sequence costs, in bits, by the probabilities that it is coded with.
  [[nodiscard]] std::vector<double> cost_bits(std::span<const int32_t> latents) const;

 private:
  LatentModel model_;
};

}  // namespace engram::encoders
