// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a rule's codec is for.

#include <string_view>

#include "ltm/codec/packed_value.h"

namespace engram::ltm {

/// The text of a rule under which arrays stay in the value, and numbers in plain datasets.
inline constexpr std::string_view kStays = "none";
/// That of one under which numbers become compressed columns.
inline constexpr std::string_view kColumns = "columns";

enum class PackRuleUse : uint8_t {
  kSingle,   ///< Each array by itself, as it is recorded.
  kGroup,    ///< Images in groups, when they are sealed.
  kNumbers,  ///< Numbers that stay in the value.
};

/// Errors: kInvalidArgument where the rule contradicts itself.
Result<PackRuleUse> use_of(const PackRule& rule);

}  // namespace engram::ltm
