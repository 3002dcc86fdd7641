// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/coding/mixer.h"
#include "ltm/idf/layout.h"

namespace engram::encoders {

/// The way in which numbers are kept. The values are part of the format.
enum class NumberKind : uint8_t {
  kBounded = 0,      ///< Each within an absolute error.
  kExact = 1,        ///< Every bit.
  kOrientation = 2,  ///< A unit quaternion w, x, y, z within an angle, with the sign it had.
  kExactFloat = 3,   ///< Every bit of a float32. All numbers of the field must be float32.
};

[[nodiscard]] constexpr bool is_exact(NumberKind kind) {
  return kind == NumberKind::kExact || kind == NumberKind::kExactFloat;
}

/// A run of numbers of one kind.
struct NumberField {
  NumberKind kind = NumberKind::kBounded;
  uint32_t count = 1;  ///< Numbers; 4 for an orientation.
  /// Max error. Unit: that of the numbers; rad for an orientation; unused if exact.
  double bound = 1e-3;

  friend bool operator==(const NumberField&, const NumberField&) = default;
};

/// Returns the fields of the numeric members of a layout in their order, without images. Whole
/// numbers and booleans are exact, orientations have `orientation_bound_rad`, and all other numbers
/// have `bound`. A bound of 0 makes numbers, or orientations, exact.
[[nodiscard]] std::vector<NumberField> number_fields(const idf::Layout& layout, double bound,
                                                     double orientation_bound_rad);

/// The kind of a feature from which a number is predicted. The values are part of the format.
enum class FeatureKind : uint8_t {
  kChange = 0,        ///< Its change in the previous row.
  kChangeBefore = 1,  ///< Its change in the row before that.
  kChangeNow = 2,     ///< Its change in this row; for earlier channels only.
  /// Its value in this row minus the last value of the predicted channel; for earlier channels
  /// only.
  kLevelNow = 3,
  kLevel = 4,  ///< Its last value minus the last value of the predicted channel.
};
inline constexpr size_t kFeatureKinds = 5;

struct PredictorTerm {
  FeatureKind kind = FeatureKind::kChange;
  uint16_t channel = 0;
  int16_t weight = 0;  ///< In 1/4096.

  friend bool operator==(const PredictorTerm&, const PredictorTerm&) = default;
};

/// A channel has one integer per row: a number, or one of the three parameters of an orientation.
struct NumberChannel {
  /// An exact number is an integer over 10^decimals, rounded to float32 if it is one. kAsOrdered
  /// stands for ordered bits.
  uint8_t decimals = 0;
  /// In the first channel of an orientation: share of the last turn that continues, in 1/8.
  uint8_t eighths = 0;
  int64_t start = 0;       ///< Prediction in the first row of a block. Unit: steps.
  int8_t start_scale = 0;  ///< Spread around `start`: 2^(x / 4) steps.
  int8_t usual_scale = 0;  ///< Typical size of a residual: 2^(x / 4) / 16 steps.
  /// Factors of the scale per estimate: 2^(x / 16).
  std::array<int8_t, 4> scale_bias{};
  std::vector<PredictorTerm> terms;  ///< At most kMaxTerms.

  static constexpr size_t kMaxTerms = 16;
  /// Value of `decimals` for a float32 that is kept as an integer made of its bits, such that close
  /// numbers have close integers.
  static constexpr uint8_t kAsOrdered = 15;
  friend bool operator==(const NumberChannel&, const NumberChannel&) = default;
};

/// Number of nodes, which are the models of the bits of a residual.
inline constexpr size_t kNumberNodes = 17;
inline constexpr size_t kScaleClasses = 24;
inline constexpr size_t kChannelNodes = 7;
inline constexpr size_t kScaleInputs = 6;
inline constexpr size_t kHoldClasses = 7;
/// Inputs of a mixer: four predictions, three adaptive contexts and a constant.
inline constexpr size_t kMixerInputs = 8;

/// The model of the numbers of an entity: bounds, predictors and the start of the adaptive models.
///
/// Threading: immutable but for assignment.
struct NumberModel {
  std::vector<NumberField> fields;
  std::vector<NumberChannel> channels;
  /// Weights, in 1/256, of the logarithms of recent residuals in the predicted logarithm of the
  /// next one.
  std::array<int16_t, kScaleInputs> scale_weights{64, 64, 32, 32, 0, 16};
  /// Log odds in 1/16, by node and scale.
  std::vector<int8_t> scale_starts = std::vector<int8_t>(kNumberNodes * kScaleClasses);
  /// By node and by the distance of the last value from the prediction.
  std::vector<int8_t> hold_starts = std::vector<int8_t>(kNumberNodes * kHoldClasses);
  /// By channel and node.
  std::vector<int8_t> channel_starts;
  /// Weights of the mixers for the first row and for other rows.
  std::array<std::array<Mixer<kMixerInputs>::Weights, kNumberNodes>, 2> mixers{};

  /// Maximum number of numbers in a row.
  static constexpr size_t kMaxNumbers = 1 << 12;

  /// Makes an untrained model, which predicts every number by its last value.
  /// Errors: kInvalidArgument, with the field, if a bound is not between 1e-150 and 1e150 (1e-9 and
  /// 1 for orientations), if an orientation does not have four numbers, or if there are more than
  /// kMaxNumbers.
  static Result<NumberModel> create(std::vector<NumberField> fields);

  /// Number of numbers per row.
  [[nodiscard]] size_t count() const;

  [[nodiscard]] std::vector<std::byte> to_bytes() const;

  /// Reads a model. It is safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition if the format is newer.
  static Result<NumberModel> from_bytes(std::span<const std::byte> bytes);

  friend bool operator==(const NumberModel&, const NumberModel&) = default;
};

}  // namespace engram::encoders
