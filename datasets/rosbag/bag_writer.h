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
/// The file appears under its name once it is closed; without that nothing is left of it.
/// Memory: one chunk and 16 bytes per message in it; of each chunk before its info, 108 bytes and 8
/// for each connection that it has messages of. Threading: one thread.
/// Source: docs/formats.md, "rosbag".
class BagWriter {
 public:
  /// Of one message: a chunk of it alone can be read again. Unit: bytes.
  static constexpr uint64_t kMaxMessageBytes = kMaxRecordBytes / 2;

  struct Options {
    /// Of a chunk before it is compressed; that of rosbag. Larger ones compress better and cost
    /// readers memory.
    uint64_t chunk_bytes = 768 << 10;
    /// "none", "bz2" (small, slow) or "lz4", which has checksums besides.
    std::string compression = "lz4";
  };

  /// Errors: kAlreadyExists where `path` is there; kInvalidArgument for another compression;
  /// kUnavailable.
  static Result<BagWriter> create(const std::filesystem::path& path, const Options& options);

  /// Comes before its messages; its id is free (checked).
  void add(Connection connection);

  /// Times are before kEndOfTime (checked).
  /// Errors: kInvalidArgument where the message is too large; kResourceExhausted and kUnavailable,
  /// here and below.
  Status write(const Message& message);

  /// Finishes the file and moves it to its name. Nothing may follow. Gives its size in bytes.
  Result<uint64_t> close();

 private:
  BagWriter(NewFile file, Options options) : file_(std::move(file)), options_(std::move(options)) {}

  Status flush_chunk();

  NewFile file_;
  Options options_;
  std::map<uint32_t, Connection> connections_;
  std::set<uint32_t> described_;  ///< Connections that are in a chunk.
  std::string chunk_;
  std::map<uint32_t, std::vector<IndexEntry>> index_;  ///< Of the open chunk.
  std::string infos_;                                  ///< Of the chunks before, as records.
  uint32_t chunks_ = 0;
};

}  // namespace engram::datasets::rosbag
