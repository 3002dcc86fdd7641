// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/file_map.h"

#include <cstring>

#include "tests/datasets/mcap/example_files.h"

namespace engram::datasets::mcap {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Key;

class FileMapTest : public testing::Test {
 protected:
  std::filesystem::path write(std::string_view bytes) const {
    overwrite_file(path_, as_bytes(bytes));
    return path_;
  }

  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "file.mcap";
};

std::string started() {
  std::string file(kMagic);
  append(file, HeaderRecord{"", ""});
  return file;
}

void finish(std::string& file) {
  append_data_end(file, 0);
  append(file, FooterRecord{});
  file += kMagic;
}

void append_message(std::string& out, uint16_t channel, uint64_t time, std::string_view data) {
  append(out, MessageRecord{channel, 0, time, time, as_bytes(data)});
}

std::string chunk_of(std::string_view records, uint64_t first, uint64_t last) {
  std::string out;
  append(out, ChunkRecord{first, last, records.size(), crc32_of(as_bytes(records)), ""},
         as_bytes(records));
  return out;
}

TEST_F(FileMapTest, ReadsTheFilesOfTheConformanceSuite) {
  for (const char* name :
       {"OneMessage-ch-chx-mx-rch-rsh-st.mcap", "OneMessage-ch-chx-mx-rch-rsh-st-sum.mcap"}) {
    const auto contents = read_all(golden(name));
    ASSERT_OK(contents);
    EXPECT_EQ(contents->report, ReadingReport{});
    ASSERT_EQ(contents->updates.size(), 1U);
    const ltm::EntityUpdate& update = contents->updates[0];
    EXPECT_EQ(update.entity.to_string(), "Data/mcap/robot/example");
    EXPECT_EQ(to_ns(update.time), 2);
    EXPECT_EQ(to_ns(update.instances[0].metadata.sent), 1);
    EXPECT_EQ(update.instances[0].data,
              (idf::Data(idf::Dict{{"encoding", "a"},
                                   {"schema", "Example"},
                                   {"bytes", idf::NdArray::take<uint8_t>({3}, {1, 2, 3})}})));
    ASSERT_EQ(contents->streams.size(), 1U);
    EXPECT_EQ(contents->streams[0].name, "example");
    EXPECT_EQ(*idf::Data(contents->streams[0].attributes).at("metadata/foo"), idf::Data("bar"));
  }
}

// Laid out by hand: opcode, length, fields.
TEST_F(FileMapTest, ReadsTheSmallestFile) {
  std::string file = "\x89MCAP0\r\n";
  file += std::string(
      "\x01\x08\0\0\0\0\0\0\0"
      "\0\0\0\0\0\0\0\0",
      17);
  file += std::string("\x02\x14\0\0\0\0\0\0\0", 9) + std::string(20, '\0');
  file += "\x89MCAP0\r\n";
  const auto contents = read_all(write(file));
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report, ReadingReport{});
  EXPECT_THAT(contents->updates, IsEmpty());
}

// Compressed by python-zstandard 0.20, without the content's size, and python-lz4 4.0.2.
TEST_F(FileMapTest, ReadsChunksThatOtherLibrariesCompressed) {
  for (const char* name : {"chunk_zstd.mcap", "chunk_lz4.mcap"}) {
    const auto contents = read_all(golden(name));
    ASSERT_OK(contents);
    EXPECT_EQ(contents->report, ReadingReport{});
    ASSERT_EQ(contents->updates.size(), 3U) << name;
    EXPECT_EQ(*contents->updates[1].instances[0].data.at("a/1"), idf::Data(2.5));
    ASSERT_NE(contents->updates[2].instances[0].data.at("image"), nullptr);
  }
}

TEST_F(FileMapTest, PutsMessagesOfOverlappingChunksInTheOrderOfTime) {
  std::string first;
  append(first, ChannelRecord{1, 0, "/a", "x", {}});
  append_message(first, 1, 10, "a");
  append_message(first, 1, 30, "c");
  std::string second;
  append_message(second, 1, 40, "d");
  append_message(second, 1, 20, "b");
  std::string file = started() + chunk_of(first, 10, 30) + chunk_of(second, 20, 40);
  append_message(file, 1, 25, "loose");
  finish(file);
  const auto contents = read_all(write(file));
  ASSERT_OK(contents);
  std::vector<int64_t> times;
  for (const auto& update : contents->updates) times.push_back(to_ns(update.time));
  EXPECT_THAT(times, testing::ElementsAre(10, 20, 25, 30, 40));
}

TEST_F(FileMapTest, MovesRepeatedTimesByOneNanosecondAndTells) {
  std::string file = started();
  append(file, ChannelRecord{1, 0, "/a", "x", {}});
  append(file, ChannelRecord{2, 0, "a", "x", {}});
  for (const uint16_t channel : {1, 1, 2}) append_message(file, channel, 10, "a");
  finish(file);
  const auto contents = read_all(write(file));
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 3U);
  EXPECT_EQ(to_ns(contents->updates[1].time), 11);
  EXPECT_EQ(contents->report.not_carried.at("repeated times, moved by 1 ns"), 1U);
  EXPECT_EQ(contents->updates[2].entity.to_string(), "Data/mcap/robot/a_2");
}

TEST_F(FileMapTest, SkipsUnknownRecordsAndTellsOfDamagedAttachments) {
  std::string file = started();
  file += std::string("\x80\x02\0\0\0\0\0\0\0hi", 11);
  file += std::string("\x09\x01\0\0\0\0\0\0\0x", 10);
  append(file, MetadataRecord{"robot", {{"arm", "left"}}});
  finish(file);
  const auto contents = read_all(write(file));
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report.not_carried.at("records of unknown kind 0x80"), 1U);
  EXPECT_THAT(contents->report.not_carried, Contains(Key(HasSubstr("attachment is too"))));
  EXPECT_EQ(contents->report.damaged, 1U);
  ASSERT_EQ(contents->episodes.size(), 1U);
  EXPECT_EQ(*idf::Data(contents->episodes[0].attributes).at("metadata/0/metadata/arm"),
            idf::Data("left"));
}

TEST_F(FileMapTest, NamesWhatIsNoMcap) {
  EXPECT_FAILS(open(scratch_ / "none"), StatusCode::kNotFound, "none");
  EXPECT_FAILS(open(write("")), StatusCode::kDataLoss, "has 0 bytes");
  EXPECT_FAILS(open(write("\x89MC")), StatusCode::kDataLoss, "has 3 bytes");
  EXPECT_FAILS(open(write("#ROSBAG V2.0\n")), StatusCode::kInvalidArgument, "offset 0");
  EXPECT_FAILS(open(write(std::string(kMagic) + std::string("\x05\0\0\0\0\0\0\0\0", 9))),
               StatusCode::kDataLoss, "offset 8: record 0x05, needs a header");
}

/// Two chunks, a metadata record and an attachment.
std::string small_file(const ScratchDirectory& scratch) {
  const auto path = scratch / "small.mcap";
  auto writer = McapWriter::create(path, {.chunk_bytes = 1, .compression = ""});
  ENGRAM_CHECK(writer.ok(), "no writer");
  ENGRAM_CHECK(writer->write(MetadataRecord{"robot", {{"arm", "left"}}}).ok(), "no metadata");
  write_example(*writer);
  ENGRAM_CHECK(writer->write(MessageRecord{1, 11, 5, 4, as_bytes("abc")}).ok(), "no message");
  const AttachmentRecord attachment{3, 0, "notes", "text/plain", as_bytes("hello")};
  ENGRAM_CHECK(writer->write(attachment).ok(), "no attachment");
  ENGRAM_CHECK(writer->close().ok(), "not closed");
  return content_of(path);
}

TEST_F(FileMapTest, ReadsWhatEndsEarlyAsFarAsItGoes) {
  const std::string file = small_file(scratch_);
  size_t last = 0;
  for (size_t size = kMagic.size(); size < file.size(); ++size) {
    const auto contents = read_all(write(file.substr(0, size)));
    ASSERT_OK(contents);
    EXPECT_THAT(contents->report.truncated_at, HasSubstr("file.mcap', offset ")) << size;
    EXPECT_GE(contents->updates.size(), last) << size;
    last = contents->updates.size();
  }
  EXPECT_EQ(last, 3U);
}

TEST_F(FileMapTest, TellsOfEveryDamagedByte) {
  const std::string file = small_file(scratch_);
  for (size_t at = 0; at < file.size(); ++at) {
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const auto contents = read_all(write(damaged));
    if (!contents.ok()) {
      EXPECT_THAT(contents.status().message(), HasSubstr("offset")) << at;
      continue;
    }
    const ReadingReport& report = contents->report;
    EXPECT_FALSE(report.not_carried.empty() && report.truncated_at.empty()) << at;
  }
}

TEST_F(FileMapTest, SaysWhereAChunkIsDamaged) {
  std::string records;
  append(records, ChannelRecord{1, 0, "/a", "x", {}});
  append_message(records, 1, 10, "a");
  std::string file = started() + chunk_of(records, 10, 10);
  const size_t chunk_at = started().size();
  file.back() = 'b';
  file += chunk_of(records, 10, 10);
  finish(file);
  const auto contents = read_all(write(file));
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report.damaged, 1U);
  EXPECT_THAT(contents->report.not_carried,
              Contains(Key(HasSubstr(fmt::format("offset {}: CRC of the chunk is", chunk_at)))));
  EXPECT_EQ(contents->updates.size(), 1U);
}

TEST_F(FileMapTest, AllocatesNothingForHostileLengths) {
  const std::string file = small_file(scratch_);
  for (const uint64_t hostile : {uint64_t{1} << 63, ~uint64_t{0}, uint64_t{1} << 40}) {
    for (size_t at = kMagic.size(); at + sizeof(hostile) <= file.size(); ++at) {
      std::string damaged = file;
      std::memcpy(damaged.data() + at, &hostile, sizeof(hostile));
      const auto contents = read_all(write(damaged));
      if (contents.ok()) continue;
      EXPECT_THAT(contents.status().message(), HasSubstr("offset")) << at;
    }
  }
  // A claim that compressed bytes cannot keep.
  for (const char* compression : {"zstd", "lz4"}) {
    std::string claim = started();
    append(claim, ChunkRecord{1, 1, uint64_t{1} << 28, 0, compression}, as_bytes("abc"));
    finish(claim);
    const auto contents = read_all(write(claim));
    ASSERT_OK(contents);
    EXPECT_EQ(contents->report.damaged, 1U);
  }
}

}  // namespace
}  // namespace engram::datasets::mcap
