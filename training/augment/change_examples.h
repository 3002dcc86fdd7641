// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/augment/augment_store.h"

namespace engram::training {

/// One value, and examples of one change applied to it.
struct ChangeExample {
  std::string change;
  idf::Data before;
  std::vector<idf::Data> after;  ///< Examples, each with its own random draw.
};

/// Applies every change that `options` select to the newest snapshot that can be changed.
/// Errors: kNotFound if there is none; the errors of augment_store.
Result<std::vector<ChangeExample>> change_examples(const std::filesystem::path& store,
                                                   const AugmentOptions& options, size_t each);

}  // namespace engram::training
