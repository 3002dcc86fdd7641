// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "encoders/provenance.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// A table of the bytes that the store would need with the previous model and with the new one, a
/// row each; empty if there was no previous model.
[[nodiscard]] std::string choice_text(const encoders::ModelChoice& choice);

/// Null if there was no previous model.
[[nodiscard]] Json choice_json(const encoders::ModelChoice& choice);

}  // namespace engram::reports
