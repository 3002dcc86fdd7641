// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_records.h"
#include "datasets/rosbag/rosbag_format.h"
#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::rosbag {

template <typename T>
std::string number_field(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
}

inline std::string time_field(uint32_t seconds, uint32_t nanoseconds = 0) {
  return number_field(seconds) + number_field(nanoseconds);
}

inline std::string fields_of(const Fields& fields) {
  std::string out;
  for (const auto& [name, value] : fields)
    out += number_field(static_cast<uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
  return out;
}

/// A record as the description of the format lays it out.
inline std::string record_of(Opcode opcode, Fields fields, std::string_view data) {
  fields.insert(fields.begin(), {"op", number_field(opcode)});
  const std::string header = fields_of(fields);
  return number_field(static_cast<uint32_t>(header.size())) + header +
         number_field(static_cast<uint32_t>(data.size())) + std::string(data);
}

inline std::string bag_header(uint64_t index_pos, uint32_t connections, uint32_t chunks) {
  return std::string(kMagic) + record_of(Opcode::kBagHeader,
                                         {{"index_pos", number_field(index_pos)},
                                          {"conn_count", number_field(connections)},
                                          {"chunk_count", number_field(chunks)}},
                                         std::string(30, ' '));
}

/// One of std_msgs/String.
inline std::string text_connection(uint32_t id, std::string_view topic = "/text",
                                   std::string_view definition = "string data\n") {
  return record_of(Opcode::kConnection, {{"conn", number_field(id)}, {"topic", std::string(topic)}},
                   fields_of({{"topic", std::string(topic)},
                              {"type", "std_msgs/String"},
                              {"md5sum", "992ce8a1687cec8c8bd883ec73ca41d1"},
                              {"message_definition", std::string(definition)}}));
}

inline std::string text_message(uint32_t connection, uint32_t seconds, std::string_view text) {
  return record_of(Opcode::kMessage,
                   {{"conn", number_field(connection)}, {"time", time_field(seconds)}},
                   number_field(static_cast<uint32_t>(text.size())) + std::string(text));
}

inline std::string chunk_of(std::string_view records) {
  return record_of(
      Opcode::kChunk,
      {{"compression", "none"}, {"size", number_field(static_cast<uint32_t>(records.size()))}},
      records);
}

/// Of messages in the chunk before; offsets in it, which no reader of ours believes, are zero.
inline std::string index_of(uint32_t connection, const std::vector<uint32_t>& seconds) {
  std::string entries;
  for (const uint32_t second : seconds) entries += time_field(second) + number_field(uint32_t{0});
  return record_of(Opcode::kIndex,
                   {{"ver", number_field(uint32_t{1})},
                    {"conn", number_field(connection)},
                    {"count", number_field(static_cast<uint32_t>(seconds.size()))}},
                   entries);
}

inline std::string chunk_info(uint64_t chunk_pos, uint32_t first, uint32_t last) {
  return record_of(Opcode::kChunkInfo,
                   {{"ver", number_field(uint32_t{1})},
                    {"chunk_pos", number_field(chunk_pos)},
                    {"start_time", time_field(first)},
                    {"end_time", time_field(last)},
                    {"count", number_field(uint32_t{0})}},
                   "");
}

/// Two chunks that overlap in time.
inline std::string small_bag() {
  const size_t begin = bag_header(0, 1, 2).size();
  const std::string first =
      chunk_of(text_connection(0) + text_message(0, 10, "a") + text_message(0, 30, "c")) +
      index_of(0, {10, 30});
  const std::string second =
      chunk_of(text_message(0, 40, "d") + text_message(0, 20, "b")) + index_of(0, {40, 20});
  return bag_header(begin + first.size() + second.size(), 1, 2) + first + second +
         text_connection(0) + chunk_info(begin, 10, 30) + chunk_info(begin + first.size(), 20, 40);
}

/// Bags that Python's rosbag made by write_bag.py.
inline std::filesystem::path golden(std::string_view name) {
  return std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/golden/rosbag" / name;
}

inline Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& path,
                                                     const ReadingOptions& options = {}) {
  return make_rosbag_format()->open(path, options);
}

/// All that a reader gives.
struct Contents {
  std::vector<ltm::EntityUpdate> updates;
  std::vector<RecordingStream> streams;
  ReadingReport report;
};

inline Result<Contents> read_all(const std::filesystem::path& path,
                                 const ReadingOptions& options = {}) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, open(path, options));
  Contents contents;
  contents.streams = reader->streams();
  Time last = Time::min();
  while (true) {
    ENGRAM_ASSIGN_OR_RETURN(auto moment, reader->next());
    if (!moment) break;
    if (moment->commit.updates.empty()) continue;
    ENGRAM_RETURN_IF_ERROR(moment->commit.check());
    ENGRAM_CHECK(moment->commit.updates[0].time >= last, "times go back");
    last = moment->commit.updates[0].time;
    for (auto& update : moment->commit.updates) contents.updates.push_back(std::move(update));
  }
  contents.report = reader->report();
  return contents;
}

}  // namespace engram::datasets::rosbag
