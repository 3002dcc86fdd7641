// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "ltm/core/config.h"
#include "ltm/redaction/redaction_options.h"

namespace engram::ltm {

/// Reads `redact` of a recording rule: {detector, action, grow, hold, timeout}. Nothing is opened.
/// Errors: kInvalidArgument naming file, line and key.
/// Source: docs/recording.md, section "Redaction".
Result<RedactionOptions> read_redaction(const ConfigValue& value);

/// Reads a detector as it is written there, from a text of its own: "people", or
/// "{program: [./find.py, --fast]}". `name` is its name in errors.
/// Errors: as above.
Result<DetectorOptions> parse_detector(std::string_view text, const std::string& name);

}  // namespace engram::ltm
