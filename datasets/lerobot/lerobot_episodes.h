// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the list of episodes and their files.

#include <istream>
#include <map>
#include <nlohmann/json_fwd.hpp>

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/lerobot/lerobot_table.h"

namespace engram::datasets::lerobot {

/// Parses meta/episodes.jsonl, which has one line per episode. Safe on hostile text.
/// Errors: kInvalidArgument naming `path`, line, what was found and what was needed.
Result<std::vector<Episode>> parse_episode_lines(const std::filesystem::path& path,
                                                 std::istream& lines);

/// Parses meta/episodes/chunk-000/file-000, which has one row per episode. Safe on hostile tables.
/// Errors: kInvalidArgument naming table, row, column, what was found and what was needed.
Result<std::vector<Episode>> parse_episode_rows(const Description& description, RowTable& rows);

/// Reads meta/episodes.jsonl or, from v3 on, the tables below meta/episodes. The result is ordered
/// by number. Errors: kNotFound; those of the functions above and of RowTable::open.
Result<std::vector<Episode>> read_episodes(const Description& description);

/// Returns the names of tasks by their numbers, from meta/tasks.jsonl or meta/tasks.parquet; empty
/// if there is neither.
Result<std::map<int64_t, std::string>> read_tasks(const Description& description);

/// Appends the texts in a value: the value itself, or texts in lists and dicts. Values that are
/// nested deeper than such names ever are get ignored.
void collect_texts(const nlohmann::json& value, std::vector<std::string>& texts);

}  // namespace engram::datasets::lerobot
