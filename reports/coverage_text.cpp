// SPDX-License-Identifier: Apache-2.0
#include "reports/coverage_text.h"

#include <fmt/format.h>

#include <cmath>

#include "reports/plain/text.h"

namespace engram::reports {

std::string within_text(const training::Coverage& told) {
  if (told.predictions == 0) return "-";
  std::string text = fmt::format("{:.1f} %", 100 * told.share());
  if (told.vacuous > 0) text += fmt::format(", {} say nothing", count_text(told.vacuous));
  return text;
}

std::string image_width_text(const training::Coverage& told) {
  return db_text(told.width_db);
}

std::string number_width_text(const training::Coverage& told) {
  // Errors of numbers are told as roots of mean squares, so half of the decibels.
  return std::isnan(told.width_db) ? "-"
                                   : fmt::format("x {:.2f}", std::pow(10, told.width_db / 20));
}

}  // namespace engram::reports
