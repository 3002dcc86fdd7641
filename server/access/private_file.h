// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: files with secrets.

#include <filesystem>
#include <string>

#include "ltm/core/status.h"

namespace engram::server {

/// Fails where the file of a secret is none, or where others than its owner and group can read it,
/// others than its owner can change it, or the owner is neither this user nor root.
/// Errors: kNotFound, kUnavailable; kFailedPrecondition naming what to change.
Status check_private_file(const std::filesystem::path& path);

/// Its text, at most `max_bytes`; checked as it was opened.
/// Errors: the same; kInvalidArgument where it is longer.
Result<std::string> read_private_file(const std::filesystem::path& path, size_t max_bytes);

}  // namespace engram::server
