// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "training/augment/augment_store.h"

namespace engram::training {

/// One value, and what a change by itself makes of it.
struct ChangeExample {
  std::string change;
  idf::Data before;
  std::vector<idf::Data> after;  ///< Drawn one after the other.
};

/// Shows every change that `options` choose on the newest snapshot that can be changed.
/// Errors: kNotFound where there is none; those of augment_store.
Result<std::vector<ChangeExample>> change_examples(const std::filesystem::path& store,
                                                   const AugmentOptions& options, size_t each);

}  // namespace engram::training
