// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the coder of rows of latents that encoder, decoder and training share.

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

/// The bits of a latent: whether it is zero, whether it is negative, and whether its magnitude is
/// above 1, 2, ... 12. The rest of a larger magnitude is coded as an integer.
inline constexpr size_t kLatentUnary = 12;
inline constexpr size_t kLatentNodes = 2 + kLatentUnary;

/// Number of contexts that estimate each bit. The mixer has one more input, a constant.
inline constexpr size_t kLatentContexts = 7;
using LatentMixer = Mixer<kLatentContexts + 1>;

/// Kinds of rows: the first row of a block has no past, so it has mixers of its own.
inline constexpr size_t kRowKinds = 2;

/// A port that sums ideal code lengths instead of writing bytes.
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

/// Codes the rows of one block in order and learns from each.
///
/// Threading: one thread.
class LatentRowCoder {
 public:
  /// Number of starts and of weights of a model.
  [[nodiscard]] static size_t start_count(const std::vector<LatentGrid>& grids);
  [[nodiscard]] static size_t weight_count(const std::vector<LatentGrid>& grids);

  /// `model` must outlive the coder.
  explicit LatentRowCoder(const LatentModel& model);

  /// Encodes a row, or decodes into it.
  template <typename Port>
  void code_row(Port& port, std::span<int32_t> row);

  /// Stores the learned state in `model` as the start of every block.
  void store(LatentModel& model);

  /// Forgets the rows and keeps the learned state.
  void begin_block();

 private:
  /// The ranges of the contexts of a grid among those of all grids.
  struct Contexts {
    std::array<size_t, kLatentContexts> offset{};  ///< Offset of each kind of context.
    size_t end = 0;
  };
  struct Grid {
    LatentGrid shape;
    Contexts contexts;
    LatentNeighbourhood around;
    std::vector<uint8_t> change;  ///< Per place: change of the coarser grid there.
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
  /// Codes a latent that is not zero. `mixers` has one mixer per node; `last` is the latent's value
  /// in the last row.
  template <typename Port>
  int32_t code_other(Port& port, Grid& grid, Place place, LatentMixer* mixers, int32_t last,
                     int32_t value);

  const LatentModel& model_;
  const OddsTable& odds_;
  std::vector<Grid> grids_;
  /// [node, context]: the bits of one node lie together for the cache. They are made on first use,
  /// because most blocks have no large latents.
  std::array<std::vector<OddsBit>, kLatentNodes> bits_;
  std::vector<LatentMixer> mixers_;  ///< [grid, row kind, node].
  std::vector<int32_t> last_;        ///< Zeros before the first row.
  size_t rows_ = 0;
};

}  // namespace engram::encoders
