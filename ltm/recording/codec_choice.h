// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/codec/packed_value.h"
#include "ltm/core/config.h"

namespace engram::ltm {

/// Checks whether a rule can be used. kFailedPrecondition means that the rule is valid but its
/// encoder is not installed here.
using CodecCheck = std::function<Status(const PackRule& rule)>;

/// Returns the rule with `codec` as its codec. From a list it takes the first one that `check`
/// accepts as installed. If a list has group codecs, the rule's journal codec is used only with
/// these.
/// Errors: kInvalidArgument naming the place in the file, also if a later codec of a list is
/// invalid or none can be used.
/// Source: docs/recording.md, section "Rules".
Result<PackRule> choose_codec(const ConfigValue& codec, const PackRule& rule,
                              const CodecCheck& check);

}  // namespace engram::ltm
