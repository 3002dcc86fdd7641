// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "datasets/vault/vault_folder.h"

namespace engram::datasets::vault {

/// Finds the days that texts name: IDs of any level, `NAMES @ 2022-02-18`, `NAMES @
/// 2022-02-18..2022-02-20`, or queries whose selectors are `all`, a time, or a range of times. A
/// day has one key, so it is named as a whole if a text names any moment between its first and its
/// last snapshot. Days without keys are left out. Errors: kInvalidArgument if a text is none of
/// these; kNotFound if one names no day.
Result<std::vector<EntityDay>> find_vault_days(const VaultKeys& keys,
                                               const std::vector<std::string>& texts);

}  // namespace engram::datasets::vault
