// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "encoders/range_coder.h"

namespace engram::encoders {

/// Turns the integer latents of one snapshot into bytes that decode alone.
///
/// The table of a latent is chosen by its channel and by the size of the latents around it that
/// are already known. A code ends with a checksum of 32 bits.
/// Shape: values of all grids one after the other, each [channels, height, width].
/// Threading: const-parallel.
/// Source: docs/learning.md, section "The code of a latent".
class LatentCoder {
 public:
  /// Tables per channel of a grid with more than one place; of one with a single place there is
  /// one per channel.
  static constexpr size_t kContexts = 24;

  LatentCoder() = default;

  /// Takes stored tables, in the order of tables().
  /// Errors: kDataLoss where their number does not fit the grids.
  static Result<LatentCoder> create(std::vector<LatentGrid> grids,
                                    std::vector<FrequencyTable> tables);

  [[nodiscard]] std::vector<std::byte> encode(std::span<const int32_t> values) const;

  /// Safe on hostile bytes.
  /// Errors: kDataLoss where the checksum does not fit.
  Result<std::vector<int32_t>> decode(std::span<const std::byte> code) const;

  [[nodiscard]] const std::vector<LatentGrid>& grids() const { return grids_; }
  [[nodiscard]] const std::vector<FrequencyTable>& tables() const { return tables_; }

  /// Number of values of all grids.
  [[nodiscard]] size_t count() const;

 private:
  std::vector<LatentGrid> grids_;
  std::vector<FrequencyTable> tables_;
};

/// Counts latents and makes the tables that code them well.
///
/// Threading: one thread.
class LatentStatistics {
 public:
  explicit LatentStatistics(std::vector<LatentGrid> grids);

  /// Values beyond +-32767 count as that.
  void add(std::span<const int32_t> values);

  [[nodiscard]] LatentCoder coder() const;

 private:
  struct Histogram {
    int32_t first = 0;
    std::vector<uint64_t> counts;
    void add(int32_t value);
  };

  std::vector<LatentGrid> grids_;
  std::vector<Histogram> histograms_;
};

}  // namespace engram::encoders
