// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "datasets/mcap/mcap_records.h"
#include "datasets/recordings/new_file.h"

namespace engram::datasets::mcap {

/// Writes an MCAP file: messages in chunks, with all indexes, statistics and checksums.
///
/// The file appears under its name when it is closed; if it is never closed, nothing of it remains.
/// Memory: one chunk, and at least 80 bytes per chunk for its index. Threading: one thread.
class McapWriter {
 public:
  struct Options {
    /// Size of a chunk before compression. Larger chunks compress better and cost readers memory.
    uint64_t chunk_bytes = 1 << 20;
    std::string compression = "zstd";  ///< "zstd", "lz4" or "" (none).
    /// Whether the data section has a checksum; chunks and summary always have one. Readers must
    /// read the whole file to verify it.
    bool has_data_checksum = true;
    std::string profile;
    std::string library;
  };

  /// Errors: kAlreadyExists if `path` exists; kUnavailable.
  static Result<McapWriter> create(const std::filesystem::path& path, const Options& options);

  /// A schema must be added before its channels, and a channel before its messages. `schema.id` is
  /// at least 1. They are written with the first message that needs them.
  void add(SchemaRecord schema);
  void add(ChannelRecord channel);

  /// Errors, also of the functions below: kResourceExhausted, kUnavailable.
  Status write(const MessageRecord& message);
  Status write(const MetadataRecord& metadata);
  Status write(const AttachmentRecord& attachment);

  /// Completes the file and renames it. No other call may follow. Returns the file's size in bytes.
  Result<uint64_t> close();

 private:
  McapWriter(NewFile file, Options options)
      : file_(std::move(file)), options_(std::move(options)) {}

  Status put(std::string_view bytes);
  Status flush_chunk();
  Status put_summary();
  void describe(uint16_t channel_id);

  NewFile file_;
  Options options_;
  uint32_t crc_ = 0;
  std::map<uint16_t, SchemaRecord> schemas_;
  std::map<uint16_t, ChannelRecord> channels_;
  std::set<uint16_t> written_schemas_;
  std::set<uint16_t> written_channels_;
  std::string chunk_;
  ChunkRecord chunk_start_;
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> chunk_index_;
  std::vector<ChunkIndexRecord> chunks_;
  std::string metadata_index_;
  std::string attachment_index_;
  StatisticsRecord statistics_;
};

}  // namespace engram::datasets::mcap
