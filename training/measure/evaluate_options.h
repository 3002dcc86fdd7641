// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace engram::training {

struct EvaluateOptions {
  /// Queries without selectors; empty: every entity with a model.
  std::vector<std::string> entities;
  /// Most predictions to measure per entity and horizon, evenly spaced. Each costs some 10 ms.
  size_t max_predictions = 2000;
};

}  // namespace engram::training
