// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Such as "38.2 dB, from the noise of 32 images".
[[nodiscard]] std::string bound_text(double bound_db, int64_t noise_images);

/// Such as "304 latents, 16 refined": the kept forms, without those that have no rows.
[[nodiscard]] std::string kept_text(const encoders::StoredForms& forms);

/// Lines that say in which forms images were kept, and how many bytes each form alone would take.
[[nodiscard]] std::vector<std::string> forms_text(const encoders::StoredForms& forms);

[[nodiscard]] Json forms_json(const encoders::StoredForms& forms);

}  // namespace engram::reports
