// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::speech {

/// The finger joints of one hand among the numbers of a value.
struct HandJoints {
  std::string hand;             ///< "left", "right", or "gripper" where the names tell no side.
  std::vector<size_t> columns;  ///< Among joint_numbers().
  bool is_gripper = false;      ///< Its joints are called grippers: larger is wider.
};

/// The positions in a value of joints, in the order of its members: floats by their names, and
/// arrays of floats. Velocities, efforts and the like are left out, and what has more than 1,024
/// numbers has none.
[[nodiscard]] std::vector<double> joint_numbers(const idf::Data& value);

/// The names of these numbers. Elements of an array are called by `joint_names`, as a description
/// of a robot gives them, where there are as many.
[[nodiscard]] std::vector<std::string> joint_names(const idf::Data& value,
                                                   const std::vector<std::string>& described);

/// The hands that joints of these names are of: "kRightHandIndex", "left_index_1", "gripper.pos".
/// A thumb turns against the fingers while it closes, so its joints count only where a hand has no
/// others.
/// Source: docs/verbalisation.md, section "Deeds that nobody told".
[[nodiscard]] std::vector<HandJoints> hands_among(const std::vector<std::string>& names);

/// How far a hand is open: the mean of its joints. Nothing where a joint is missing or not finite.
[[nodiscard]] std::optional<double> mean_of(const HandJoints& hand,
                                            const std::vector<double>& numbers);

}  // namespace engram::speech
