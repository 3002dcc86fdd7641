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
/// It never forces a write to the disk and never fails: if the store cannot be written to, or its
/// notes have reached their limit, reads are not noted. A killed process loses the reads that it
/// had not written yet.
/// Owns: its file and the lock on it.
/// Threading: one thread; any number of logs of one store in any process.
/// Source: docs/format.md, section "Access logs".
class AccessLog {
 public:
  struct Options {
    /// Number of reads that are gathered before they are written.
    size_t batch = 1024;
    /// A read also writes a smaller batch if the first read of that batch is this old.
    Duration interval = std::chrono::seconds(2);
    /// A log that reaches this size is closed and the next one is begun.
    uint64_t file_bytes = uint64_t{1} << 20;
    /// Max bytes and files below `access/`. At either limit notes are dropped until logs are
    /// merged.
    uint64_t max_bytes = uint64_t{64} << 20;
    size_t max_files = 4096;
  };

  AccessLog(std::filesystem::path store, const Options& options, Clock clock = system_now);
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;
  /// Calls flush().
  ~AccessLog();

  void note(const MemoryId& entity, Time snapshot);

  /// Writes all gathered reads to the log.
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

/// Reads all notes of a store. Notes that are damaged or cannot be read are left out.
[[nodiscard]] AccessTable read_accesses(const std::filesystem::path& store);

/// Merges the logs whose readers have ended into one summary, without the snapshots in `gone`.
/// Does nothing if another process is merging at the same time.
/// A kill at any moment loses no note and counts none twice.
/// Errors: kUnavailable, kResourceExhausted.
Status merge_accesses(const std::filesystem::path& store,
                      const std::map<MemoryId, TimeSet>& gone = {});

/// Calls merge_accesses() if many files or bytes have gathered. Otherwise it only lists the folder.
Status merge_grown_accesses(const std::filesystem::path& store);

}  // namespace engram::ltm
