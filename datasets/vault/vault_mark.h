// SPDX-License-Identifier: Apache-2.0
#pragma once

// The file that says that a directory is a vault, and which one; who changes the vault locks it.

#include <filesystem>
#include <optional>

#include "datasets/vault/sealed_file.h"
#include "ltm/core/file.h"

namespace engram::datasets::vault {

/// Reads the ID of the vault in a directory.
/// Errors: kNotFound if there is no vault; kDataLoss; kFailedPrecondition if it is newer.
Result<RandomId> read_vault_id(const std::filesystem::path& vault);

/// Locks the mark, since copies of the key file of its vault have locks of their own. Nothing if
/// there is no mark, or where nothing can be locked.
/// Errors: kFailedPrecondition if another process holds it; kUnavailable.
Result<std::optional<File>> lock_vault_mark(const std::filesystem::path& vault);

/// Makes the mark, locked before it has its name. It is written to `made` first.
/// Errors: kFailedPrecondition if another process has made one meanwhile, unless a damaged one is
/// replaced; those of writing.
Result<File> make_vault_mark(const std::filesystem::path& vault, const RandomId& id,
                             const std::filesystem::path& made, bool replaces_damaged);

}  // namespace engram::datasets::vault
