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

/// The measured error of an engine for one member. Unit: that of the member, squared.
struct MemberRecord {
  size_t predictions = 0;  ///< Number of measured predictions.
  double mean = std::numeric_limits<double>::quiet_NaN();
  double bound = std::numeric_limits<double>::quiet_NaN();  ///< With kBoundProbability.

  /// Summarizes mean squared errors. Those that are not finite are left out.
  static MemberRecord of(std::vector<double> squares) {
    std::erase_if(squares, [](double square) { return !std::isfinite(square); });
    if (squares.empty()) return {};
    double sum = 0;
    for (const double square : squares) sum += square;
    return {squares.size(), sum / static_cast<double>(squares.size()),
            bound_of(std::move(squares))};
  }
};

/// Records of the moments when the member was at rest, and of those when it moved.
struct MotionRecords {
  MemberRecord at_rest, moving;
  /// Movements in the whole past, and not only in the last third, because movements are rare. Only
  /// engines that do not learn have this record: the others have learned from that past.
  MemberRecord ever_moving = {};

  [[nodiscard]] const MemberRecord& of(bool is_moving) const {
    return is_moving ? moving : at_rest;
  }
};

/// Gathers the errors of one member to make records of them.
struct MotionErrors {
  std::array<std::vector<double>, 2> squares;  ///< First those at rest, then those moving.

  void add(bool is_moving, double square) { squares[is_moving ? 1 : 0].push_back(square); }
  [[nodiscard]] MotionRecords records() && {
    return {MemberRecord::of(std::move(squares[0])), MemberRecord::of(std::move(squares[1]))};
  }
};

/// The measured errors of an engine for each member.
struct MemberRecords {
  std::string engine;
  std::vector<MotionRecords> members;
};

}  // namespace engram::ltm
