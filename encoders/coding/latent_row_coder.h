// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the one coder of rows of latents that encoder, decoder and training share.

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "encoders/coding/integer_coder.h"
#include "encoders/coding/latent_neighbourhood.h"
#include "encoders/coding/latent_sequence.h"
#include "encoders/coding/mixer.h"
#include "encoders/coding/odds_bit.h"

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
class LatentRowCoder {
 public:
  /// Number of starts and weights of a model.
  [[nodiscard]] static size_t start_count(const std::vector<LatentGrid>& grids);
  [[nodiscard]] static size_t weight_count(const std::vector<LatentGrid>& grids);

  /// `model` outlives the coder.
  explicit LatentRowCoder(const LatentModel& model);

  /// Encodes a row, or decodes into it.
  template <typename Port>
  void code_row(Port& port, std::span<int32_t> row);

  /// Puts what was learned where the next block starts from.
  void store(LatentModel& model);

  /// Forgets the rows, keeps what was learned.
  void begin_block();

 private:
  /// Where the contexts of a grid lie among all.
  struct Contexts {
    std::array<size_t, kLatentContexts> offset{};  ///< Of each kind of context.
    size_t end = 0;
  };
  struct Grid {
    LatentGrid shape;
    Contexts contexts;
    LatentNeighbourhood around;
    std::vector<uint8_t> change;  ///< Per place: how much the grid before changed below it.
    IntegerModel large;
  };
  /// The contexts of one latent.
  using Place = std::array<size_t, kLatentContexts>;

  static std::vector<Contexts> lay_out(const std::vector<LatentGrid>& grids);
  std::vector<OddsBit>& bits_of(size_t node);
  [[nodiscard]] Place place_of(const Grid& grid, size_t at, size_t channel, size_t place) const;
  template <typename Port>
  bool code_bit(Port& port, const Place& place, LatentMixer& mixer, std::vector<OddsBit>& bits,
                bool bit);
  /// A latent that is not zero. `mixers` [node]; `last`: the same in the last row.
  template <typename Port>
  int32_t code_other(Port& port, Grid& grid, Place place, LatentMixer* mixers, int32_t last,
                     int32_t value);

  const LatentModel& model_;
  const OddsTable& odds_;
  std::vector<Grid> grids_;
  /// [node, context]: what is asked together lies together. Made where it is asked for: most blocks
  /// have no large latents.
  std::array<std::vector<OddsBit>, kLatentNodes> bits_;
  std::vector<LatentMixer> mixers_;  ///< [grid, row kind, node].
  std::vector<int32_t> last_;        ///< Zeros before the first row.
  size_t rows_ = 0;
};

}  // namespace engram::encoders
