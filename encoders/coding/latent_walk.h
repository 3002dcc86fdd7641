// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the one walk over rows of latents that encoder, decoder and training share.

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "encoders/coding/adaptive_bit.h"
#include "encoders/coding/integer_coder.h"
#include "encoders/coding/latent_sequence.h"
#include "encoders/coding/mixer.h"

namespace engram::encoders {

/// Bits that a latent is told by: is it zero, is it negative, is its magnitude above 1, 2, ... 12;
/// what is above that follows as an integer of its own.
inline constexpr size_t kLatentUnary = 12;
inline constexpr size_t kLatentNodes = 2 + kLatentUnary;

/// Contexts that estimate a bit at the same time, and a constant.
inline constexpr size_t kLatentContexts = 7;
using LatentMixer = Mixer<kLatentContexts + 1>;

/// The kinds of rows that are told apart: the first of a block knows no past.
inline constexpr size_t kRowKinds = 2;

/// Ideal lengths instead of bytes.
class BitCounter {
 public:
  static constexpr bool kIsDecoder = false;
  bool code(bool bit, BitProbability one) {
    bits_ -= std::log2(static_cast<double>(bit ? one : 65536 - one) / 65536.0);
    return bit;
  }
  [[nodiscard]] double bits() const { return bits_; }

 private:
  double bits_ = 0;
};

/// Codes the rows of one block, one after the other, and learns from each.
///
/// Threading: one thread.
class LatentWalk {
 public:
  /// Number of starts and weights of a model.
  [[nodiscard]] static size_t start_count(const std::vector<LatentGrid>& grids);
  [[nodiscard]] static size_t weight_count(const std::vector<LatentGrid>& grids);

  /// `model` outlives the walk.
  explicit LatentWalk(const LatentModel& model);

  /// Encodes a row, or decodes into it.
  template <typename Port>
  void code_row(Port& port, std::span<int32_t> row);

  /// Puts what was learned where the next block starts from.
  void store(LatentModel& model) const;

  /// Forgets the rows, keeps what was learned.
  void begin_block();

 private:
  struct Grid {
    LatentGrid shape;
    size_t first = 0;                              ///< Of its latents in a row.
    size_t base = 0;                               ///< Of its contexts.
    std::array<size_t, kLatentContexts> offset{};  ///< Of each kind of context behind the base.
    std::vector<uint8_t> change;  ///< Per place: how much the grid before changed below it.
  };
  /// The indices of a latent's contexts, each the first of kLatentNodes bits.
  struct Place {
    std::array<size_t, kLatentContexts> context{};
    size_t row_kind = 0;
    size_t relation = 0;  ///< Where the contexts by distance from the last value begin.
    int32_t last = 0;
    size_t grid = 0;
  };

  static std::vector<Grid> lay_out(const std::vector<LatentGrid>& grids, size_t& contexts);
  [[nodiscard]] Place place_of(const Grid& grid, size_t number, std::span<const int32_t> row, int c,
                               int y, int x) const;
  void note_changes(Grid& grid, const Grid& coarser, std::span<const int32_t> row) const;
  template <typename Port>
  int32_t code_latent(Port& port, const Place& place, int32_t value);
  template <typename Port>
  bool code_bit(Port& port, const Place& place, size_t node, size_t relation, bool bit);

  std::vector<Grid> grids_;
  std::vector<AdaptiveBit> bits_;
  std::vector<LatentMixer> mixers_;  ///< [grid, row kind, node].
  std::vector<IntegerModel> large_;  ///< Per grid.
  std::vector<int32_t> last_, before_;
  size_t rows_ = 0;
};

}  // namespace engram::encoders
