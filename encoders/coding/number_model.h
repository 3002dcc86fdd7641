// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/mixer.h"
#include "ltm/idf/layout.h"

namespace engram::encoders {

/// How numbers are kept. The values are part of the format.
enum class NumberKind : uint8_t {
  kBounded = 0,      ///< Each within an absolute error.
  kExact = 1,        ///< Every bit.
  kOrientation = 2,  ///< A unit quaternion w, x, y, z within an angle, with the sign it had.
  kExactFloat = 3,   ///< Every bit of a float32, which all of them have to be.
};

[[nodiscard]] constexpr bool is_exact(NumberKind kind) {
  return kind == NumberKind::kExact || kind == NumberKind::kExactFloat;
}

/// A run of numbers of one kind.
struct NumberField {
  NumberKind kind = NumberKind::kBounded;
  uint32_t count = 1;  ///< Numbers; 4 for an orientation.
  /// Largest error. Unit: that of the numbers; rad for an orientation; unused where exact.
  double bound = 1e-3;

  friend bool operator==(const NumberField&, const NumberField&) = default;
};

/// The fields of the numeric members of a layout in their order, images left out: whole numbers
/// and truth values are exact, orientations are orientations, all else has `bound`; 0, also of
/// orientations, is exact.
[[nodiscard]] std::vector<NumberField> number_fields(const idf::Layout& layout, double bound,
                                                     double orientation_bound_rad);

/// A number that helps to predict another. The values are part of the format.
enum class FeatureKind : uint8_t {
  kChange = 0,        ///< What it changed by in the row before.
  kChangeBefore = 1,  ///< What it changed by in the one before that.
  kChangeNow = 2,     ///< What it changes by in this row: only of channels that come before.
  kLevelNow = 3,      ///< This row's value minus the predicted one's last: as kChangeNow.
  kLevel = 4,         ///< Its last value minus the predicted one's last.
};
inline constexpr size_t kFeatureKinds = 5;

struct PredictorTerm {
  FeatureKind kind = FeatureKind::kChange;
  uint16_t channel = 0;
  int16_t weight = 0;  ///< In 1/4096.

  friend bool operator==(const PredictorTerm&, const PredictorTerm&) = default;
};

/// One integer per row: a number, or one of three of an orientation.
struct NumberChannel {
  /// Of an exact number: it is an integer over 10^decimals, rounded where it is a float32; or
  /// kAsOrdered.
  uint8_t decimals = 0;
  uint8_t eighths = 0;     ///< Of an orientation's first: how much of the last turn goes on.
  int64_t start = 0;       ///< What a block starts from. Unit: steps.
  int8_t start_scale = 0;  ///< Spread around it: 2^(x / 4) steps.
  int8_t usual_scale = 0;  ///< Size of a residual: 2^(x / 4) / 16 steps.
  /// Corrections of the scale per estimate: 2^(x / 16).
  std::array<int8_t, 4> scale_bias{};
  std::vector<PredictorTerm> terms;  ///< At most kMaxTerms.

  static constexpr size_t kMaxTerms = 16;
  /// A float32 is the integer that its bits make, such that close numbers have close integers.
  static constexpr uint8_t kAsOrdered = 15;
  friend bool operator==(const NumberChannel&, const NumberChannel&) = default;
};

/// Which of the models of a residual's bits is asked.
inline constexpr size_t kNumberNodes = 17;
inline constexpr size_t kScaleClasses = 24;
inline constexpr size_t kChannelNodes = 7;
inline constexpr size_t kScaleInputs = 6;
inline constexpr size_t kHoldClasses = 7;
/// Four predictions, three adaptive contexts, a constant.
inline constexpr size_t kMixerInputs = 8;

/// What is known of an entity's numbers before a block is read: bounds, predictors and where the
/// adaptive models start.
///
/// Threading: immutable but for assignment.
struct NumberModel {
  std::vector<NumberField> fields;
  std::vector<NumberChannel> channels;
  /// Weights of the logarithms of recent residuals in that of the next, in 1/256.
  std::array<int16_t, kScaleInputs> scale_weights{64, 64, 32, 32, 0, 16};
  /// Log odds in 1/16, by node and scale.
  std::vector<int8_t> scale_starts = std::vector<int8_t>(kNumberNodes * kScaleClasses);
  /// By node and where the last value lies from the prediction.
  std::vector<int8_t> hold_starts = std::vector<int8_t>(kNumberNodes * kHoldClasses);
  /// By channel and node.
  std::vector<int8_t> channel_starts;
  /// First row, other rows.
  std::array<std::array<Mixer<kMixerInputs>::Weights, kNumberNodes>, 2> mixers{};

  /// Most numbers of a row.
  static constexpr size_t kMaxNumbers = 1 << 12;

  /// A model that knows nothing but the fields: every number is predicted by its last value.
  /// Errors: kInvalidArgument naming the field: a bound that is not between 1e-150 and 1e150 (1e-9
  /// and 1 for orientations), an orientation of other than four numbers, more than kMaxNumbers.
  static Result<NumberModel> create(std::vector<NumberField> fields);

  /// Numbers per row.
  [[nodiscard]] size_t count() const;

  [[nodiscard]] std::vector<std::byte> to_bytes() const;

  /// Safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition where the format is newer.
  static Result<NumberModel> from_bytes(std::span<const std::byte> bytes);

  friend bool operator==(const NumberModel&, const NumberModel&) = default;
};

}  // namespace engram::encoders
