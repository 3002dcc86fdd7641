// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "ltm/core/file.h"
#include "ltm/core/time_set.h"
#include "ltm/recall/access_table.h"

namespace engram::ltm {

/// Notes which snapshots of a store were read, in a file of its own below `access/`.
///
/// Nothing is forced to the disk and nothing fails: where the store cannot be written to, or its
/// notes have grown to their limit, nothing is noted. Killed, it loses what was not written out.
/// Owns: its file and the lock on it.
/// Threading: one thread; any number of logs of one store in any process.
/// Source: docs/format.md, section "Access logs".
class AccessLog {
 public:
  struct Options {
    /// Reads that are gathered before they are written.
    size_t batch = 1024;
    /// So are fewer, where the first of them came this long ago, at the next read.
    Duration interval = std::chrono::seconds(2);
    /// Most bytes of a log; then the next one is begun.
    uint64_t file_bytes = uint64_t{1} << 20;
    /// Most bytes and files below `access/`; more notes are dropped until they are merged.
    uint64_t max_bytes = uint64_t{64} << 20;
    size_t max_files = 4096;
  };

  AccessLog(std::filesystem::path store, const Options& options, Clock clock = system_now);
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;
  /// Writes out what was noted.
  ~AccessLog();

  void note(const MemoryId& entity, Time snapshot);

  /// Writes out what was noted.
  void flush();

 private:
  Status write();
  Status open_file();

  std::filesystem::path store_;
  Options options_;
  Clock clock_;
  AccessTable noted_;
  size_t reads_ = 0;
  Time first_{};
  std::optional<File> file_;
};

/// All that was noted of a store; of what is damaged, or cannot be read, nothing.
[[nodiscard]] AccessTable read_accesses(const std::filesystem::path& store);

/// Makes one summary of all notes whose readers are gone, without the snapshots that are `gone`
/// themselves. Leaves everything as it is where another process does that now.
/// Killed at any moment, nothing is lost or counted twice.
/// Errors: kUnavailable, kResourceExhausted.
Status merge_accesses(const std::filesystem::path& store,
                      const std::map<MemoryId, TimeSet>& gone = {});

/// The same where many files or bytes have gathered; costs a look into the folder elsewhere.
Status merge_grown_accesses(const std::filesystem::path& store);

}  // namespace engram::ltm
