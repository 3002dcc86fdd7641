// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// "38.2 dB, from the noise of 32 images".
[[nodiscard]] std::string bound_text(double bound_db, int64_t noise_images);

/// "304 latents, 16 refined": what was kept, as far as there is any.
[[nodiscard]] std::string kept_text(const encoders::StoredForms& forms);

/// How images were kept, and what each form alone would take, in lines.
[[nodiscard]] std::vector<std::string> forms_text(const encoders::StoredForms& forms);

[[nodiscard]] Json forms_json(const encoders::StoredForms& forms);

}  // namespace engram::reports
