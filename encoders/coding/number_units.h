// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "encoders/coding/number_model.h"

// Private to this room: numbers as the integers that are predicted and coded, and back.

namespace engram::encoders {

/// Of a bounded number: a step, and its bound. Unit: units.
inline constexpr int64_t kStepUnits = 8191;
inline constexpr double kBoundUnits = 4096;
/// What is larger is stored as it is. Unit: units.
inline constexpr int64_t kMaxUnits = int64_t{1} << 40;

/// Order of the bits is order of the numbers: close numbers have close integers.
[[nodiscard]] uint64_t ordered(double value);
[[nodiscard]] double from_ordered(uint64_t code);

/// The same of a float32, zero in the middle. Any integer may be turned back: what lies beyond is
/// taken as the last one.
[[nodiscard]] int64_t ordered_float(float value);
[[nodiscard]] float from_ordered_float(int64_t code);

[[nodiscard]] bool has_same_bits(double a, double b);

/// Double to the unit that a channel is kept in and back.
[[nodiscard]] double to_units(const NumberField& field, const NumberChannel& channel, double value);
[[nodiscard]] double from_units(const NumberField& field, const NumberChannel& channel,
                                int64_t units);
[[nodiscard]] int64_t step_units(const NumberField& field);

/// True where an exact number is what `decimals` says, bit by bit.
[[nodiscard]] bool has_decimals(const NumberField& field, uint8_t decimals, double value);

}  // namespace engram::encoders
