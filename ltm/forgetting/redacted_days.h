// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// Marks of the redactions that replaced originals, by entity and UTC day: another mark after each.
/// So whoever keeps a copy of a day sees that it may show what was redacted since.
using RedactedDays = std::map<MemoryId, std::map<std::string, uint64_t>>;

/// The UTC day of a time as these name it: "2022-02-18".
[[nodiscard]] std::string redacted_day(Time time);

/// Reads the reports of erasures of a store. Those of earlier programs name no days.
/// Errors: kDataLoss naming a damaged report; kUnavailable.
Result<RedactedDays> read_redacted_days(const std::filesystem::path& store);

}  // namespace engram::ltm
