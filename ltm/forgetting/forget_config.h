// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/forgetting/forget_options.h"

namespace engram::ltm {

/// Reads the section `forget` of a configuration. The file is the one that `engram import --config`
/// takes too; its sections for recording are ignored. `name` is its name in errors.
/// Errors: kInvalidArgument naming file, line and key (for an unknown key also the closest known
/// one), also if there is no such section.
/// Source: docs/forgetting.md.
Result<ForgetOptions> parse_forget_config(std::string_view text, const std::string& name);

/// Reads the section `forget` of a file.
/// Errors: as above; kNotFound; kUnavailable.
Result<ForgetOptions> read_forget_config(const std::filesystem::path& path);

}  // namespace engram::ltm
