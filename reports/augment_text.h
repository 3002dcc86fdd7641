// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "reports/plain/output.h"
#include "training/augment/augment_store.h"

namespace engram::reports {

/// What was made of a store's snapshots, and what was left out.
[[nodiscard]] Json augment_json(const training::AugmentReport& report, const std::string& store,
                                const std::string& out, const training::AugmentOptions& options);
void print_augmented(const training::AugmentReport& report, const std::string& out);

}  // namespace engram::reports
