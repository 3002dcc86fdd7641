// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "reports/plain/output.h"
#include "training/augment/augment_store.h"

namespace engram::reports {

/// Reports the snapshots that were made from a store's, and those left out.
[[nodiscard]] Json augment_json(const training::AugmentReport& report, const std::string& store,
                                const std::string& out, const training::AugmentOptions& options);
void print_augmented(const training::AugmentReport& report, const std::string& out);

}  // namespace engram::reports
