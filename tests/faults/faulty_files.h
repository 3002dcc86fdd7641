// SPDX-License-Identifier: Apache-2.0
#pragma once

/// A layer between a program and its files that fails where it is told to and remembers what was
/// done. Loaded before libc (LD_PRELOAD, or linked), it sees every change below one directory.
///
/// With LD_PRELOAD the environment tells what to do: ENGRAM_FAULTS_ROOT (the directory),
/// ENGRAM_FAULTS_CALL and ENGRAM_FAULTS_KIND (which call fails and how, as the number of a kind),
/// ENGRAM_FAULTS_TRACE (file that the trace goes to). Files whose names begin with "told" are
/// traced, but neither counted nor failed.
/// Threading: thread-safe; the changes have one order.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What a call does. The values are part of the trace.
enum FileChange {
  kFileCreate = 1,
  kFileWrite = 2,
  kFileSync = 3,
  kFileTruncate = 4,
  kFileRename = 5,
  kFileUnlink = 6,
  kFileMkdir = 7,
  kFileLink = 8,  ///< A second name of a file.
  kFileSyncSystem =
      9,  ///< Forces all files of the file system; told with the path of its descriptor.
};

enum FileFault {
  kFaultNone = 0,
  kFaultShort = 1,    ///< One write takes half of the bytes, and says so.
  kFaultNoSpace = 2,  ///< One call finds the disk full.
  kFaultFull = 3,    ///< The disk is full from this call on; a write takes half of its bytes first.
  kFaultBroken = 4,  ///< One call fails with EIO.
  kFaultDead = 5,    ///< This and all further calls fail with EIO.
};

/// One change in a trace, followed by the bytes of path, second path and data.
struct FileRecord {
  int64_t call;    ///< Its number; 0 where it is not counted.
  uint64_t file;   ///< Inode; the same number is another file once it was created again.
  int64_t offset;  ///< Of a write; the new size where it was truncated.
  uint64_t bytes;
  uint32_t change;
  uint32_t path_bytes;
  uint32_t second_path_bytes;
  uint32_t is_directory;
};

/// Watches the changes below `root`, an absolute path; the count begins anew.
void faulty_files_watch(const char* root);

/// Lets call number `call` (1, 2, ...) fail.
void faulty_files_fail(int64_t call, int kind);

/// Appends every change that succeeds to a file outside of `root`.
void faulty_files_trace(const char* file);

/// Changes that were tried since faulty_files_watch.
int64_t faulty_files_calls(void);

#ifdef __cplusplus
}
#endif
