// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_writer.h"

#include <algorithm>
#include <fstream>

#include "datasets/rosbag/bag_compression.h"
#include "tests/datasets/rosbag/example_bags.h"

namespace engram::datasets::rosbag {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

const std::string kDefinition = "string data\n";

Connection text_connection_of(uint32_t id, const std::string& topic) {
  return {id,
          topic,
          "std_msgs/String",
          "992ce8a1687cec8c8bd883ec73ca41d1",
          kDefinition,
          {{"topic", topic}, {"latching", "1"}}};
}

std::string packed_text(std::string_view text) {
  return number_field(static_cast<uint32_t>(text.size())) + std::string(text);
}

constexpr uint64_t seconds(uint64_t count, uint64_t nanoseconds = 0) {
  return count * 1'000'000'000 + nanoseconds;
}

/// A record, its fields by their names and where it begins: as the description of the format has
/// it, without anything of ours.
struct Parsed {
  size_t at = 0;
  std::map<std::string, std::string> fields;
  std::string data;

  template <typename T>
  [[nodiscard]] T number(const std::string& name) const {
    T value{};
    const std::string& bytes = fields.at(name);
    EXPECT_EQ(bytes.size(), sizeof(T)) << name;
    std::memcpy(&value, bytes.data(), std::min(bytes.size(), sizeof(T)));
    return value;
  }
  [[nodiscard]] int op() const { return number<uint8_t>("op"); }
};

uint32_t length_at(std::string_view bytes, size_t at) {
  uint32_t length = 0;
  std::memcpy(&length, bytes.substr(at, 4).data(), 4);
  return length;
}

std::map<std::string, std::string> parsed_fields(std::string_view bytes) {
  std::map<std::string, std::string> fields;
  for (size_t at = 0; at < bytes.size();) {
    const std::string_view field = bytes.substr(at + 4, length_at(bytes, at));
    const size_t equals = field.find('=');
    fields[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    at += 4 + field.size();
  }
  return fields;
}

std::vector<Parsed> parsed(std::string_view bytes, size_t at = 0) {
  std::vector<Parsed> records;
  while (at < bytes.size()) {
    const uint32_t header = length_at(bytes, at);
    const uint32_t data = length_at(bytes, at + 4 + header);
    records.push_back({at, parsed_fields(bytes.substr(at + 4, header)),
                       std::string(bytes.substr(at + 8 + header, data))});
    at += 8 + header + data;
  }
  EXPECT_EQ(at, bytes.size());
  return records;
}

class BagWriterTest : public testing::Test {
 protected:
  [[nodiscard]] std::string content() const {
    const auto bytes = read_file(path_);
    EXPECT_OK(bytes);
    return std::string(as_text(bytes->bytes()));
  }

  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "file.bag";
};

std::string padded_header(uint64_t index_pos, uint32_t connections, uint32_t chunks) {
  const Fields fields{{"index_pos", number_field(index_pos)},
                      {"conn_count", number_field(connections)},
                      {"chunk_count", number_field(chunks)}};
  const size_t header = record_of(Opcode::kBagHeader, fields, "").size() - 8;
  return std::string(kMagic) +
         record_of(Opcode::kBagHeader, fields, std::string(4096 - header, ' '));
}

TEST_F(BagWriterTest, WritesWhatTheDescriptionOfTheFormatSays) {
  auto writer = BagWriter::create(path_, {.compression = "none"});
  ASSERT_OK(writer);
  writer->add(text_connection_of(0, "/text"));
  ASSERT_OK(writer->write({0, seconds(10, 5), as_bytes(packed_text("a"))}));
  ASSERT_OK(writer->write({0, seconds(20), as_bytes(packed_text("bc"))}));
  const auto size = writer->close();
  ASSERT_OK(size);

  const std::string connection =
      record_of(Opcode::kConnection, {{"conn", number_field(uint32_t{0})}, {"topic", "/text"}},
                fields_of({{"type", "std_msgs/String"},
                           {"md5sum", "992ce8a1687cec8c8bd883ec73ca41d1"},
                           {"message_definition", kDefinition},
                           {"topic", "/text"},
                           {"latching", "1"}}));
  const std::string first = record_of(
      Opcode::kMessage, {{"conn", number_field(uint32_t{0})}, {"time", time_field(10, 5)}},
      packed_text("a"));
  const auto first_at = static_cast<uint32_t>(connection.size());
  const auto second_at = static_cast<uint32_t>(first_at + first.size());
  const std::string chunk = chunk_of(connection + first + text_message(0, 20, "bc"));
  const std::string index = record_of(
      Opcode::kIndex,
      {{"ver", number_field(uint32_t{1})},
       {"conn", number_field(uint32_t{0})},
       {"count", number_field(uint32_t{2})}},
      time_field(10, 5) + number_field(first_at) + time_field(20) + number_field(second_at));
  const uint64_t chunk_at = kMagic.size() + 4 + 4096 + 4;
  const std::string info = record_of(Opcode::kChunkInfo,
                                     {{"ver", number_field(uint32_t{1})},
                                      {"chunk_pos", number_field(chunk_at)},
                                      {"start_time", time_field(10, 5)},
                                      {"end_time", time_field(20)},
                                      {"count", number_field(uint32_t{1})}},
                                     number_field(uint32_t{0}) + number_field(uint32_t{2}));
  const std::string expected = padded_header(chunk_at + chunk.size() + index.size(), 1, 1) + chunk +
                               index + connection + info;
  EXPECT_EQ(*size, expected.size());
  EXPECT_EQ(content(), expected);
}

TEST_F(BagWriterTest, IndexesEveryMessageOfChunksOfEveryCompression) {
  constexpr uint32_t kMessages = 40;
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    path_ = scratch_ / (compression + ".bag");
    auto writer = BagWriter::create(path_, {.chunk_bytes = 1000, .compression = compression});
    ASSERT_OK(writer);
    for (const uint32_t id : {3U, 5U})
      writer->add(text_connection_of(id, fmt::format("/text_{}", id)));
    for (uint32_t i = 0; i < kMessages; ++i) {
      // The other connection begins late.
      const uint32_t id = i > 20 && i % 3 == 0 ? 5 : 3;
      ASSERT_OK(writer->write({id, seconds(i, i), as_bytes(packed_text(std::string(i * 7, 'x')))}));
    }
    ASSERT_OK(writer->close());

    const auto records = parsed(content(), kMagic.size());
    const auto of_kind = [&](int op) {
      std::vector<Parsed> found;
      std::ranges::copy_if(records, std::back_inserter(found),
                           [op](const Parsed& record) { return record.op() == op; });
      return found;
    };
    const auto chunks = of_kind(0x05);
    const auto infos = of_kind(0x06);
    ASSERT_GT(chunks.size(), 3U);
    ASSERT_EQ(infos.size(), chunks.size());
    EXPECT_THAT(of_kind(0x07), SizeIs(2)) << "behind the chunks, each once";
    EXPECT_EQ(records[0].number<uint64_t>("index_pos"), of_kind(0x07)[0].at);
    EXPECT_EQ(records[0].number<uint32_t>("conn_count"), 2U);
    EXPECT_EQ(records[0].number<uint32_t>("chunk_count"), chunks.size());

    uint32_t seen = 0;
    std::map<uint32_t, int> described;
    for (size_t i = 0; i < chunks.size(); ++i) {
      EXPECT_EQ(infos[i].number<uint64_t>("chunk_pos"), chunks[i].at);
      EXPECT_EQ(chunks[i].fields.at("compression"), compression);
      const auto plain =
          decompress(compression, as_bytes(chunks[i].data), chunks[i].number<uint32_t>("size"));
      ASSERT_OK(plain);
      const auto inside = parsed(as_text(plain->bytes()));
      std::map<size_t, const Parsed*> messages;
      for (const Parsed& record : inside) {
        const auto id = record.number<uint32_t>("conn");
        if (record.op() == 0x07) ++described[id];
        if (record.op() != 0x02) continue;
        EXPECT_EQ(described[id], 1) << "a connection comes before its messages";
        messages[record.at] = &record;
      }
      const size_t end = i + 1 < chunks.size() ? chunks[i + 1].at : of_kind(0x07)[0].at;
      size_t indexed = 0;
      std::string counts;
      for (const Parsed& record : records) {
        if (record.op() != 0x04 || record.at < chunks[i].at || record.at > end) continue;
        const auto count = record.number<uint32_t>("count");
        EXPECT_EQ(record.data.size(), count * 12);
        counts += record.fields.at("conn") + record.fields.at("count");
        for (size_t at = 0; at < record.data.size(); at += 12) {
          const Parsed* message = messages.at(length_at(record.data, at + 8));
          EXPECT_EQ(message->fields.at("time"), record.data.substr(at, 8));
          EXPECT_EQ(message->fields.at("conn"), record.fields.at("conn"));
          ++indexed;
        }
      }
      EXPECT_EQ(indexed, messages.size());
      EXPECT_EQ(infos[i].data, counts);
      EXPECT_EQ(infos[i].fields.at("start_time"), messages.begin()->second->fields.at("time"));
      EXPECT_EQ(infos[i].fields.at("end_time"), messages.rbegin()->second->fields.at("time"));
      seen += static_cast<uint32_t>(indexed);
    }
    EXPECT_EQ(seen, kMessages);
    const auto contents = read_all(path_);
    ASSERT_OK(contents);
    EXPECT_EQ(contents->report, ReadingReport{});
    EXPECT_THAT(contents->updates, SizeIs(kMessages));
  }
}

TEST_F(BagWriterTest, WritesABagOfNothing) {
  auto writer = BagWriter::create(path_, {});
  ASSERT_OK(writer);
  ASSERT_OK(writer->close());
  EXPECT_EQ(content(), padded_header(kMagic.size() + 4 + 4096 + 4, 0, 0));
  const auto contents = read_all(path_);
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report, ReadingReport{});
  EXPECT_THAT(contents->streams, IsEmpty());
}

TEST_F(BagWriterTest, KeepsConnectionsWithoutMessages) {
  auto writer = BagWriter::create(path_, {});
  ASSERT_OK(writer);
  writer->add(text_connection_of(0, "/silent"));
  writer->add(text_connection_of(1, "/text"));
  ASSERT_OK(writer->write({1, seconds(1), as_bytes(packed_text("a"))}));
  ASSERT_OK(writer->close());
  const auto contents = read_all(path_);
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report, ReadingReport{});
  std::vector<std::pair<std::string, uint64_t>> streams;
  for (const auto& stream : contents->streams) streams.emplace_back(stream.name, stream.values);
  EXPECT_THAT(streams, ElementsAre(testing::Pair("/silent", 0U), testing::Pair("/text", 1U)));
}

TEST_F(BagWriterTest, WritesTimesUpToTheLast) {
  auto writer = BagWriter::create(path_, {});
  ASSERT_OK(writer);
  writer->add(text_connection_of(0, "/text"));
  ASSERT_OK(writer->write({0, 0, as_bytes(packed_text("first"))}));
  ASSERT_OK(writer->write({0, kEndOfTime - 1, as_bytes(packed_text("last"))}));
  ASSERT_OK(writer->close());
  const auto contents = read_all(path_);
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 2U);
  EXPECT_EQ(to_ns(contents->updates[0].time), 0);
  EXPECT_EQ(to_ns(contents->updates[1].time), 4'294'967'295'999'999'999);
}

TEST_F(BagWriterTest, LeavesNothingWhereItIsNotClosed) {
  {
    auto writer = BagWriter::create(path_, {.chunk_bytes = 1});
    ASSERT_OK(writer);
    writer->add(text_connection_of(0, "/text"));
    ASSERT_OK(writer->write({0, 1, as_bytes(packed_text("a"))}));
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_F(BagWriterTest, RefusesWhatNobodyCouldRead) {
  std::ofstream(path_) << "mine";
  EXPECT_FAILS(BagWriter::create(path_, {}), StatusCode::kAlreadyExists, "file.bag");
  EXPECT_EQ(content(), "mine");
  EXPECT_FAILS(BagWriter::create(scratch_ / "other.bag", {.compression = "zstd"}),
               StatusCode::kInvalidArgument, "'zstd'");
  auto writer = BagWriter::create(scratch_ / "large.bag", {});
  ASSERT_OK(writer);
  writer->add(text_connection_of(0, "/text"));
  const std::byte one{};
  const std::span<const std::byte> large(&one, BagWriter::kMaxMessageBytes + 1);
  EXPECT_FAILS(writer->write({0, 1, large}), StatusCode::kInvalidArgument, "268435457 bytes");
}

}  // namespace
}  // namespace engram::datasets::rosbag
