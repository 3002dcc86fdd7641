// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_writer.h"

#include <algorithm>

#include "datasets/rosbag/bag_compression.h"
#include "ltm/core/check.h"

namespace engram::datasets::rosbag {

Result<BagWriter> BagWriter::create(const std::filesystem::path& path, const Options& options) {
  ENGRAM_RETURN_IF_ERROR(check_compression(options.compression));
  ENGRAM_ASSIGN_OR_RETURN(NewFile file, NewFile::create(path));
  BagWriter writer(std::move(file), options);
  std::string start(kMagic);
  append(start, BagHeader{});
  ENGRAM_RETURN_IF_ERROR(writer.file_.append(start));
  return writer;
}

void BagWriter::add(Connection connection) {
  const uint32_t id = connection.id;
  const bool is_new = connections_.emplace(id, std::move(connection)).second;
  ENGRAM_CHECK(is_new, "connection {} is there", id);
}

Status BagWriter::write(const Message& message) {
  if (message.data.size() > kMaxMessageBytes)
    return invalid_argument("message of {} bytes, a bag of ours has at most {}",
                            message.data.size(), kMaxMessageBytes);
  // A large message gets a chunk of its own, so that no chunk exceeds what can be read.
  if (chunk_.size() + message.data.size() > kMaxMessageBytes) ENGRAM_RETURN_IF_ERROR(flush_chunk());
  if (described_.insert(message.connection).second)
    append(chunk_, connections_.at(message.connection));
  index_[message.connection].push_back({message.time, static_cast<uint32_t>(chunk_.size())});
  append(chunk_, message);
  return chunk_.size() < options_.chunk_bytes ? Status() : flush_chunk();
}

Status BagWriter::flush_chunk() {
  if (chunk_.empty()) return {};
  ENGRAM_ASSIGN_OR_RETURN(const std::string packed,
                          compress(options_.compression, as_bytes(chunk_)));
  ChunkInfo info{file_.size(), kEndOfTime, 0, {}};
  std::string records;
  append_chunk(records, options_.compression, chunk_.size(), packed);
  for (const auto& [connection, entries] : index_) {
    append_index(records, connection, entries);
    info.messages[connection] = static_cast<uint32_t>(entries.size());
    const auto [first, last] = std::ranges::minmax(entries, {}, &IndexEntry::time);
    info.start_time = std::min(info.start_time, first.time);
    info.end_time = std::max(info.end_time, last.time);
  }
  append(infos_, info);
  ++chunks_;
  chunk_.clear();
  index_.clear();
  return file_.append(records);
}

Result<uint64_t> BagWriter::close() {
  ENGRAM_RETURN_IF_ERROR(flush_chunk());
  const BagHeader header{file_.size(), static_cast<uint32_t>(connections_.size()), chunks_};
  std::string records;
  for (const auto& [id, connection] : connections_) append(records, connection);
  ENGRAM_RETURN_IF_ERROR(file_.append(records));
  ENGRAM_RETURN_IF_ERROR(file_.append(infos_));
  std::string start;
  append(start, header);
  ENGRAM_RETURN_IF_ERROR(file_.overwrite(kMagic.size(), start));
  ENGRAM_RETURN_IF_ERROR(file_.publish());
  return file_.size();
}

}  // namespace engram::datasets::rosbag
