// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: numbers of a step as values.

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/lerobot/lerobot_table.h"
#include "ltm/idf/data.h"

namespace engram::datasets::lerobot {

/// The columns of a feature, one for each number. Tables call number i of "observation.state": it
/// and the name or number of the element, or only "state" and these. Empty where one is missing.
std::vector<size_t> columns_of(const RowTable& table, const Feature& feature);

/// A number for each name; else {"values"}, an array of the feature's type and shape; of texts
/// {"text"}. Nothing where a cell is empty.
/// Errors: kInvalidArgument naming table, row and column.
Result<std::optional<idf::Dict>> numbers_of(const RowTable& table, const Feature& feature,
                                            const std::vector<size_t>& columns);

/// "front" of "observation.images.front".
[[nodiscard]] std::string last_part(const std::string& key);

}  // namespace engram::datasets::lerobot
