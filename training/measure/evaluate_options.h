// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace engram::training {

struct EvaluateOptions {
  /// Queries without selectors; empty for every entity with a model.
  std::vector<std::string> entities;
  /// Max number of evenly spaced predictions per entity and horizon. Each costs about 10 ms.
  size_t max_predictions = 2000;
};

}  // namespace engram::training
