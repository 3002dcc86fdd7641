// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/number_units.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace engram::encoders {

namespace {

constexpr std::array<double, 16> kPowers{1,   1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                         1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

double from_decimals(const NumberField& field, uint8_t decimals, double units) {
  const double value = units / kPowers[decimals];
  return field.kind == NumberKind::kExactFloat ? static_cast<double>(static_cast<float>(value))
                                               : value;
}

bool is_ordered(const NumberField& field, uint8_t decimals) {
  return field.kind == NumberKind::kExactFloat && decimals == NumberChannel::kAsOrdered;
}

}  // namespace

uint64_t ordered(double value) {
  const auto bits = std::bit_cast<uint64_t>(value);
  return (bits >> 63) != 0 ? ~bits : bits | (uint64_t{1} << 63);
}

double from_ordered(uint64_t code) {
  return std::bit_cast<double>((code >> 63) != 0 ? code & ~(uint64_t{1} << 63) : ~code);
}

int64_t ordered_float(float value) {
  const auto bits = std::bit_cast<uint32_t>(value);
  constexpr uint32_t kSign = uint32_t{1} << 31;
  return int64_t{(bits & kSign) != 0 ? ~bits : bits | kSign} - int64_t{kSign};
}

float from_ordered_float(int64_t code) {
  constexpr int64_t kSign = int64_t{1} << 31;
  const auto bits = static_cast<uint32_t>(std::clamp(code, -kSign, kSign - 1) + kSign);
  return std::bit_cast<float>((bits >> 31) != 0 ? bits & 0x7fffffffU : ~bits);
}

bool has_same_bits(double a, double b) {
  return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}

double to_units(const NumberField& field, const NumberChannel& channel, double value) {
  if (!is_exact(field.kind)) return value / (field.bound / kBoundUnits);
  if (is_ordered(field, channel.decimals))
    return static_cast<double>(ordered_float(static_cast<float>(value)));
  return std::nearbyint(value * kPowers[channel.decimals]);
}

double from_units(const NumberField& field, const NumberChannel& channel, int64_t units) {
  if (!is_exact(field.kind)) return static_cast<double>(units) * (field.bound / kBoundUnits);
  if (is_ordered(field, channel.decimals)) return from_ordered_float(units);
  return from_decimals(field, channel.decimals, static_cast<double>(units));
}

int64_t step_units(const NumberField& field) {
  return field.kind == NumberKind::kBounded ? kStepUnits : 1;
}

bool has_decimals(const NumberField& field, uint8_t decimals, double value) {
  if (is_ordered(field, decimals))
    return has_same_bits(static_cast<double>(static_cast<float>(value)), value);
  const double whole = std::nearbyint(value * kPowers[decimals]);
  if (!(std::abs(whole) <= static_cast<double>(kMaxUnits / 2))) return false;
  // The conversion to an integer removes the sign of zero.
  const auto units = static_cast<double>(static_cast<int64_t>(whole));
  return has_same_bits(from_decimals(field, decimals, units), value);
}

}  // namespace engram::encoders
