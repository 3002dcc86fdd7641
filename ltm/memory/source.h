// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "ltm/core/time.h"

namespace engram::ltm {

using engram::to_string;

/// Where a value that a query answered with comes from; what is closer to the truth first.
enum class Source : uint8_t {
  kRecorded,       ///< As it was committed.
  kReconstructed,  ///< Decoded from a latent by a model.
  kAugmented,      ///< Changed on purpose from what was recorded.
  kPredicted,      ///< A moment after the last snapshot, or one that was not recorded.
};

/// "recorded", "reconstructed", "augmented", "predicted".
[[nodiscard]] std::string_view to_string(Source source);
[[nodiscard]] std::optional<Source> source_from_name(std::string_view name);

/// How far a value is from the recorded one, measured after decoding what is stored, or expected.
/// Not a number where the value has no member of that kind.
struct MeasuredError {
  /// Mean squared error over all elements of all image members. Unit: grey levels squared.
  double image_mse = std::numeric_limits<double>::quiet_NaN();
  /// Mean squared error over all other tensor elements. Unit: that of the numbers, squared.
  double number_mse = std::numeric_limits<double>::quiet_NaN();

  /// NaNs are equal.
  friend bool operator==(const MeasuredError& a, const MeasuredError& b);
};

}  // namespace engram::ltm
