// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"
#include "encoders/provenance.h"

namespace engram::cli {

/// How images were kept, in one line, with what other forms would have taken.
[[nodiscard]] std::string forms_text(const encoders::StoredForms& forms);

[[nodiscard]] Json forms_json(const encoders::StoredForms& forms);

}  // namespace engram::cli
