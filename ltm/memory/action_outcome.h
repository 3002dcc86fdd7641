// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "ltm/idf/data.h"
#include "ltm/idf/type.h"

namespace engram::ltm {

/// How an action ended, or that it has not ended yet.
enum class ActionOutcome : uint8_t { kUnknown, kRunning, kSuccess, kFailure, kStop };

/// "running", "success", "failure", "stop" or "unknown".
[[nodiscard]] std::string_view name_of(ActionOutcome outcome);

/// What a text tells of an outcome, whatever its case: "FAILED", "preempted", "succeeded".
[[nodiscard]] ActionOutcome outcome_named(std::string name);

/// What the member `member` of a value tells: a bool says success or failure, a text is read by
/// outcome_named, an integer by the names of the enum that `type`, the type of the whole value, has
/// for this member.
[[nodiscard]] ActionOutcome outcome_of(const idf::Data& value, std::string_view member,
                                       const std::optional<idf::Type>& type);

}  // namespace engram::ltm
