// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the use of a rule's codec.

#include <string_view>

#include "ltm/codec/packed_value.h"

namespace engram::ltm {

/// The codec text of a rule that keeps arrays in the value and numbers in plain datasets.
inline constexpr std::string_view kStays = "none";
/// The codec text of a rule that stores numbers as compressed columns.
inline constexpr std::string_view kColumns = "columns";

enum class PackRuleUse : uint8_t {
  kSingle,   ///< Each array is encoded alone when it is recorded.
  kGroup,    ///< Images are encoded in groups when they are sealed.
  kNumbers,  ///< Numbers, which stay in the value.
};

/// Errors: kInvalidArgument if the rule contradicts itself.
Result<PackRuleUse> use_of(const PackRule& rule);

}  // namespace engram::ltm
