// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/codec/packed_value.h"
#include "ltm/core/config.h"

namespace engram::ltm {

/// Whether a rule can be used. kFailedPrecondition: not here, its encoder is not installed.
using CodecCheck = std::function<Status(const PackRule& rule)>;

/// Puts the text of `codec` into the rule: of a list, the first that `check` finds installed. Where
/// a list has codecs of groups, the rule's journal is for these alone.
/// Errors: kInvalidArgument naming the place, also where a later one of a list makes no sense, and
/// where none can be used.
/// Source: docs/recording.md, section "Rules".
Result<PackRule> choose_codec(const ConfigValue& codec, const PackRule& rule,
                              const CodecCheck& check);

}  // namespace engram::ltm
