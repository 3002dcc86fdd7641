// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "ltm/core/time.h"

namespace engram::ltm {

using engram::to_string;

/// The origin of a value in an answer, the closest to the truth first.
enum class Source : uint8_t {
  kRecorded,       ///< As it was committed.
  kReconstructed,  ///< Decoded from a latent by a model.
  kAugmented,      ///< Deliberately changed from what was recorded.
  kPredicted,      ///< Predicted: after the last snapshot, or at a moment that was not recorded.
};

/// "recorded", "reconstructed", "augmented", "predicted".
[[nodiscard]] std::string_view to_string(Source source);
[[nodiscard]] std::optional<Source> source_from_name(std::string_view name);

/// The distance of a value from the recorded one: measured after decoding what is stored, or
/// expected. NaN where the value has no member of that kind.
struct MeasuredError {
  /// Mean squared error over all elements of all image members. Unit: grey levels squared.
  double image_mse = std::numeric_limits<double>::quiet_NaN();
  /// Mean squared error over all other tensor elements. Unit: the unit of the numbers, squared.
  double number_mse = std::numeric_limits<double>::quiet_NaN();

  /// NaNs are equal.
  friend bool operator==(const MeasuredError& a, const MeasuredError& b);
};

}  // namespace engram::ltm
