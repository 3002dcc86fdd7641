// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: files with secrets.

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::server {

/// Checks the file of a secret. It fails if the path is no regular file, if others than its owner
/// and group can read it, if others than its owner can change it, or if the owner is neither this
/// user nor root.
/// Errors: kNotFound, kUnavailable; kFailedPrecondition naming what to change.
Status check_private_file(const std::filesystem::path& path);

/// Reads the file's text, `max_bytes` at most. The checks are made on the opened file, so it cannot
/// be exchanged between check and read.
/// Errors: those of check_private_file; kInvalidArgument if it is longer.
Result<std::string> read_private_file(const std::filesystem::path& path, size_t max_bytes);

/// Writes a new file that its owner alone can read, and forces it to disk.
/// Errors: kAlreadyExists, kResourceExhausted, kUnavailable.
Status create_private_file(const std::filesystem::path& path, std::string_view text);

}  // namespace engram::server
