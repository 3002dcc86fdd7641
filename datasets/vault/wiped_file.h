// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "datasets/vault/secret_bytes.h"

namespace engram::datasets::vault {

// Files with keys in them. What they held is overwritten before their blocks are given back, as far
// as a file system lets a program do that: flash disks, journals of data, snapshots and copies on
// write keep old blocks.

/// Reads a file that its owner alone may read.
/// Errors: kNotFound; kFailedPrecondition if it is no plain file, belongs to anybody but this user
/// or root, or if others may read or change it; kUnavailable.
Result<SecretBytes> read_secret_file(const std::filesystem::path& path);

/// Puts other content in place of a file, or makes it, with permissions for its owner alone: the
/// new content is on the disk before it takes the old one's name, and the old bytes are then
/// overwritten. After a kill in between, the next call overwrites them.
/// Errors: those of check_replaceable, with which nothing changes; kResourceExhausted if the disk
/// is full, else kUnavailable. The old content then stays, or the next call overwrites it.
Status replace_secret_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Checks whether the bytes of a file, if there is one, could be overwritten.
/// Errors: those of read_secret_file, but for kNotFound; kFailedPrecondition if its owner may not
/// write to it.
Status check_replaceable(const std::filesystem::path& path);

/// Overwrites and removes what a killed replace_secret_file left beside `path`.
Status wipe_leftovers(const std::filesystem::path& path);

}  // namespace engram::datasets::vault
