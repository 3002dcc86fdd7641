// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a person does to the room, in words.

#include <optional>
#include <string>
#include <string_view>

#include "datasets/kitchen/things.h"
#include "ltm/core/status.h"

namespace engram::datasets::kitchen {

/// "chair to 1.0,2.0", "person to 0,-1,90", "person away" or "salt to table".
struct Poke {
  std::string name;
  bool is_away = false;
  std::optional<Surface> surface;
  Eigen::Vector3d at{0, 0, 0};  ///< x, y, heading. Unit: m, rad; the text has degrees.
};

/// Errors: kInvalidArgument naming the text and what was needed.
Result<Poke> parse_poke(std::string_view text);

/// Whether a person means this kind by a name: "salt_box", "salt" or "salt_box_1".
[[nodiscard]] bool is_called(const ThingClass& type, std::string_view name);

}  // namespace engram::datasets::kitchen
