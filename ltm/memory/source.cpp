// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/source.h"

#include <array>
#include <cmath>

namespace engram::ltm {

namespace {

constexpr std::array<std::string_view, 4> kNames{"recorded", "reconstructed", "augmented",
                                                 "predicted"};

bool is_same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

}  // namespace

std::string_view to_string(Source source) {
  return kNames[static_cast<size_t>(source)];
}

std::optional<Source> source_from_name(std::string_view name) {
  for (size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<Source>(i);
  return std::nullopt;
}

bool operator==(const MeasuredError& a, const MeasuredError& b) {
  return is_same(a.image_mse, b.image_mse) && is_same(a.number_mse, b.number_mse);
}

}  // namespace engram::ltm
