// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "training/measure/crossval.h"

namespace engram::reports {

/// The report as tables: folds of each variant, of what learns nothing, and all beside each other.
/// PSNR is "mean / pooled".
[[nodiscard]] std::string crossval_text(const training::CrossvalReport& report);

/// What a fold gave, a line for each variant.
[[nodiscard]] std::string fold_text(const training::CrossvalFold& fold, size_t number);

}  // namespace engram::reports
