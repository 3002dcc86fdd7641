// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "encoders/coding/number_model.h"

// Private to this room: converts numbers to the integers that are predicted and coded, and back.

namespace engram::encoders {

/// Step and bound of a bounded number. Unit: units.
inline constexpr int64_t kStepUnits = 8191;
inline constexpr double kBoundUnits = 4096;
/// Larger values are stored bit by bit. Unit: units.
inline constexpr int64_t kMaxUnits = int64_t{1} << 40;

/// Maps doubles to integers in the same order, so that close numbers have close integers.
[[nodiscard]] uint64_t ordered(double value);
[[nodiscard]] double from_ordered(uint64_t code);

/// The same for float32, with zero at 0. Any integer may be converted back: integers out of range
/// are clamped.
[[nodiscard]] int64_t ordered_float(float value);
[[nodiscard]] float from_ordered_float(int64_t code);

[[nodiscard]] bool has_same_bits(double a, double b);

/// Converts a double to the unit of a channel and back.
[[nodiscard]] double to_units(const NumberField& field, const NumberChannel& channel, double value);
[[nodiscard]] double from_units(const NumberField& field, const NumberChannel& channel,
                                int64_t units);
[[nodiscard]] int64_t step_units(const NumberField& field);

/// Whether an exact number equals its representation with `decimals`, bit by bit.
[[nodiscard]] bool has_decimals(const NumberField& field, uint8_t decimals, double value);

}  // namespace engram::encoders
