// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "datasets/recordings/new_file.h"
#include "datasets/rosbag/bag_records.h"

namespace engram::datasets::rosbag {

/// Writes a bag: messages in chunks, with all indexes.
///
/// The file appears under its name when it is closed; if it is never closed, nothing of it remains.
/// Memory: one chunk and 16 bytes per message in it; for each earlier chunk 108 bytes and 8 bytes
/// per connection with messages in it. Threading: one thread.
/// Source: docs/formats.md, "rosbag".
class BagWriter {
 public:
  /// Maximum size of a message, so that a chunk with nothing but it can be read. Unit: bytes.
  static constexpr uint64_t kMaxMessageBytes = kMaxRecordBytes / 2;

  struct Options {
    /// Size of a chunk before compression; the default is that of rosbag. Larger chunks compress
    /// better and cost readers memory.
    uint64_t chunk_bytes = 768 << 10;
    /// "none", "bz2" (small but slow) or "lz4", which also has checksums.
    std::string compression = "lz4";
  };

  /// Errors: kAlreadyExists if `path` exists; kInvalidArgument for another compression;
  /// kUnavailable.
  static Result<BagWriter> create(const std::filesystem::path& path, const Options& options);

  /// A connection must be added before its messages, and its id must be unused (checked).
  void add(Connection connection);

  /// Times must be before kEndOfTime (checked).
  /// Errors: kInvalidArgument if the message is too large; this and close() also return
  /// kResourceExhausted and kUnavailable.
  Status write(const Message& message);

  /// Completes the file and renames it. No other call may follow. Returns the file's size in bytes.
  Result<uint64_t> close();

 private:
  BagWriter(NewFile file, Options options) : file_(std::move(file)), options_(std::move(options)) {}

  Status flush_chunk();

  NewFile file_;
  Options options_;
  std::map<uint32_t, Connection> connections_;
  std::set<uint32_t> described_;  ///< Connections that were written to a chunk.
  std::string chunk_;
  std::map<uint32_t, std::vector<IndexEntry>> index_;  ///< The index of the open chunk.
  std::string infos_;                                  ///< Records that describe earlier chunks.
  uint32_t chunks_ = 0;
};

}  // namespace engram::datasets::rosbag
