// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "encoders/provenance.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// What the store would take with the previous model and with the new one, a row each under a row
/// of names; empty where there was no previous one.
[[nodiscard]] std::string choice_text(const encoders::ModelChoice& choice);

/// Null where there was no previous one.
[[nodiscard]] Json choice_json(const encoders::ModelChoice& choice);

}  // namespace engram::reports
