// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "training/augment/augment_store.h"

namespace engram::reports {

/// Writes a PNG with a row of recorded images, then a row for each change applied by itself.
/// Errors: those of change_examples; kInvalidArgument if there are no 8-bit images.
Status write_change_examples(const std::filesystem::path& store,
                             const training::AugmentOptions& options, const std::string& png);

/// Writes a PNG of a store that render_store made: a row of recorded images, then a row for each
/// kind of change, at moments spread over the whole time of one entity.
/// Errors: kNotFound if nothing was rendered; those of the stores.
Status write_rendered_examples(const std::filesystem::path& recorded,
                               const std::filesystem::path& rendered, const std::string& png);

}  // namespace engram::reports
