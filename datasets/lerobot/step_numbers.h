// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the numbers of a step as values.

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/lerobot/lerobot_table.h"
#include "ltm/idf/data.h"

namespace engram::datasets::lerobot {

/// Returns the columns of a feature, one for each number. In tables, number i of
/// "observation.state" has this name, or only "state", followed by the name or number of the
/// element. Empty if a column is missing.
std::vector<size_t> columns_of(const RowTable& table, const Feature& feature);

/// Returns a number for each name; if there are no names {"values"}, an array of the feature's type
/// and shape; for texts {"text"}. Returns nothing if a cell is empty.
/// Errors: kInvalidArgument naming table, row and column.
Result<std::optional<idf::Dict>> numbers_of(const RowTable& table, const Feature& feature,
                                            const std::vector<size_t>& columns);

/// Returns "front" for "observation.images.front".
[[nodiscard]] std::string last_part(const std::string& key);

}  // namespace engram::datasets::lerobot
