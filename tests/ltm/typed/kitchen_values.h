// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kitchen.h"

namespace engram::typed {

/// A value of the fixture tests/golden/idf/kitchen.xml, under the name of its golden files.
struct NamedScene {
  std::string name;
  kitchen::Scene scene;
};

/// All defaults; everything filled; extremes of all numbers; everything empty or absent.
[[nodiscard]] std::vector<NamedScene> kitchen_scenes();

/// One with every member set to something else than its default.
[[nodiscard]] kitchen::Scene filled_scene();

}  // namespace engram::typed
