// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "training/augment/augment_store.h"

namespace engram::reports {

/// Writes a PNG: a row for what was recorded, then one for what each change by itself makes of it.
/// Errors: those of change_examples; kInvalidArgument where there are no images of 8 bits.
Status write_change_examples(const std::filesystem::path& store,
                             const training::AugmentOptions& options, const std::string& png);

/// Writes a PNG of a store that render_store made: a row for what was recorded, then one for each
/// kind of change, at moments over the whole time of one entity.
/// Errors: kNotFound where nothing was rendered; those of the stores.
Status write_rendered_examples(const std::filesystem::path& recorded,
                               const std::filesystem::path& rendered, const std::string& png);

}  // namespace engram::reports
