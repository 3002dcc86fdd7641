// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "ltm/core/status.h"

namespace engram::soak {

inline constexpr int kServers = 3;
inline constexpr int kWriters = 8;
inline constexpr int kReaders = 8;

/// Of server `index`: 0 is "A".
[[nodiscard]] std::string memory_name(int index);
/// That writer `index` writes, in each memory.
[[nodiscard]] std::string entity_name(const std::string& memory, int writer);

// Where things are in the folder of a run.
[[nodiscard]] std::string names_endpoint(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path store_path(const std::filesystem::path& folder,
                                               const std::string& memory);
/// Times of acknowledged commits to an entity.
[[nodiscard]] std::filesystem::path ledger_path(const std::filesystem::path& folder,
                                                const std::string& memory, int writer);
/// What readers count: kAnswers, kTold, kInterrupted, kFailed or kWrong.
[[nodiscard]] std::filesystem::path reader_path(const std::filesystem::path& folder, int reader);

enum ReaderCount : int64_t { kAnswers = 1, kTold, kInterrupted, kFailed, kWrong };

// Each is one process, until it is told to end (SIGTERM) or killed.
Status run_names(const std::filesystem::path& folder);
/// `start`: how often it was started; it listens elsewhere each other time.
Status run_memory(const std::filesystem::path& folder, const std::string& memory, int start);
Status run_writer(const std::filesystem::path& folder, int index);
Status run_reader(const std::filesystem::path& folder, int index);

}  // namespace engram::soak
