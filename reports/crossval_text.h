// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "training/measure/crossval.h"

namespace engram::reports {

/// Formats the report as tables: the folds of each variant, those of the baselines that learn
/// nothing, and all side by side. PSNR is "mean / pooled".
[[nodiscard]] std::string crossval_text(const training::CrossvalReport& report);

/// Formats the results of a fold, a line per variant.
[[nodiscard]] std::string fold_text(const training::CrossvalFold& fold, size_t number);

}  // namespace engram::reports
