// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/forgetting/forget_options.h"

namespace engram::ltm {

/// Reads the section `forget` of a configuration: the file that `engram import --config` takes
/// too, whose sections for recording are not looked at. `name` is what errors call it.
/// Errors: kInvalidArgument naming file, line and key; unknown keys come with the closest known
/// one; also where there is no such section.
/// Source: docs/forgetting.md.
Result<ForgetOptions> parse_forget_config(std::string_view text, const std::string& name);

/// Errors: kNotFound and kUnavailable too.
Result<ForgetOptions> read_forget_config(const std::filesystem::path& path);

}  // namespace engram::ltm
