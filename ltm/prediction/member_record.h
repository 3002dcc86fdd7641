// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "ltm/prediction/error_bound.h"

// Private to this room.

namespace engram::ltm {

/// What an engine was worth for one member. Unit: that of the member, squared.
struct MemberRecord {
  size_t predictions = 0;  ///< That it was measured on.
  double mean = std::numeric_limits<double>::quiet_NaN();
  double bound = std::numeric_limits<double>::quiet_NaN();  ///< With kBoundProbability.

  /// Of mean squared errors; those that are no numbers are left out.
  static MemberRecord of(std::vector<double> squares) {
    std::erase_if(squares, [](double square) { return !std::isfinite(square); });
    if (squares.empty()) return {};
    double sum = 0;
    for (const double square : squares) sum += square;
    return {squares.size(), sum / static_cast<double>(squares.size()),
            bound_of(std::move(squares))};
  }
};

/// Of moments when the member was at rest, and of those when it moved.
struct MotionRecords {
  MemberRecord at_rest, moving;
  /// Of movements in all of the past, and not only where engines that learn are measured: movements
  /// are rare. Of engines that do not learn alone.
  MemberRecord ever_moving = {};

  [[nodiscard]] const MemberRecord& of(bool is_moving) const {
    return is_moving ? moving : at_rest;
  }
};

/// The errors of one member that records are made of, while they are gathered.
struct MotionErrors {
  std::array<std::vector<double>, 2> squares;  ///< At rest, moving.

  void add(bool is_moving, double square) { squares[is_moving ? 1 : 0].push_back(square); }
  [[nodiscard]] MotionRecords records() && {
    return {MemberRecord::of(std::move(squares[0])), MemberRecord::of(std::move(squares[1]))};
  }
};

/// What an engine was worth for each member.
struct MemberRecords {
  std::string engine;
  std::vector<MotionRecords> members;
};

}  // namespace engram::ltm
