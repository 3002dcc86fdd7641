// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"

namespace engram::server {

/// Checks that a file has certificates in PEM.
/// Errors: kNotFound, kUnavailable; kInvalidArgument if it has none, or has one that is broken.
[[nodiscard]] Status check_certificates(const std::filesystem::path& file);

/// Checks that a key in PEM, without a password, is that of the first certificate of a file.
/// Errors: those of check_certificates; kInvalidArgument naming what does not fit.
[[nodiscard]] Status check_key_of(const std::filesystem::path& certificate,
                                  const std::filesystem::path& key);

}  // namespace engram::server
