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
/// The file appears under its name once it is closed; without that nothing is left of it.
/// Memory: one chunk, and 80 bytes and more per chunk of its index. Threading: one thread.
class McapWriter {
 public:
  struct Options {
    /// Of a chunk before it is compressed. Larger ones compress better and cost readers memory.
    uint64_t chunk_bytes = 1 << 20;
    std::string compression = "zstd";  ///< Or "lz4" or "".
    /// Of the data section; chunks and summary always have theirs. Readers have to read all for it.
    bool has_data_checksum = true;
    std::string profile;
    std::string library;
  };

  /// Errors: kAlreadyExists where `path` is there; kUnavailable.
  static Result<McapWriter> create(const std::filesystem::path& path, const Options& options);

  /// `schema.id` is 1 or more; a schema comes before its channels and a channel before its
  /// messages. Each is written with the first message that needs it.
  void add(SchemaRecord schema);
  void add(ChannelRecord channel);

  /// Errors: kResourceExhausted, kUnavailable; here and below.
  Status write(const MessageRecord& message);
  Status write(const MetadataRecord& metadata);
  Status write(const AttachmentRecord& attachment);

  /// Finishes the file and moves it to its name. Nothing may follow. Gives its size in bytes.
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
