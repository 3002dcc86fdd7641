// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which episodes there are, and where.

#include <istream>
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/lerobot/lerobot_table.h"

namespace engram::datasets::lerobot {

/// A line of meta/episodes.jsonl each. Safe on hostile text.
/// Errors: kInvalidArgument naming `path`, line, what was found and what was needed.
Result<std::vector<Episode>> parse_episode_lines(const std::filesystem::path& path,
                                                 std::istream& lines);

/// A row of meta/episodes/chunk-000/file-000 each. Safe on hostile tables.
/// Errors: kInvalidArgument naming table, row, column, what was found and what was needed.
Result<std::vector<Episode>> parse_episode_rows(const Description& description, RowTable& rows);

/// From meta/episodes.jsonl or, from v3 on, the tables below meta/episodes; in the order of their
/// numbers. Errors: kNotFound; those of the above and of RowTable::open.
Result<std::vector<Episode>> read_episodes(const Description& description);

/// What tasks are called, by their numbers: from meta/tasks.jsonl or meta/tasks.parquet; empty
/// where there is neither.
Result<std::map<int64_t, std::string>> read_tasks(const Description& description);

/// Adds the texts in a value: it alone, or in lists and dicts of them; what is nested deeper than
/// such names ever are is left out.
void collect_texts(const nlohmann::json& value, std::vector<std::string>& texts);

}  // namespace engram::datasets::lerobot
