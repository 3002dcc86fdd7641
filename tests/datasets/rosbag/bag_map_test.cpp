// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_map.h"

#include <cstring>

#include "tests/datasets/rosbag/example_bags.h"

namespace engram::datasets::rosbag {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Key;

class BagMapTest : public testing::Test {
 protected:
  std::filesystem::path write(std::string_view bytes) const {
    overwrite_file(path_, as_bytes(bytes));
    return path_;
  }

  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "file.bag";
};

std::vector<std::string> texts(const Contents& contents) {
  std::vector<std::string> found;
  for (const auto& update : contents.updates)
    found.push_back(update.instances[0].data.at("data")->get<std::string>());
  return found;
}

TEST_F(BagMapTest, PutsMessagesOfOverlappingChunksInTheOrderOfTime) {
  const auto contents = read_all(write(small_bag()));
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report, ReadingReport{});
  EXPECT_THAT(texts(*contents), ElementsAre("a", "b", "c", "d"));
  EXPECT_EQ(to_ns(contents->updates[1].time), 20'000'000'000);
  ASSERT_EQ(contents->streams.size(), 1U);
  EXPECT_EQ(contents->streams[0].values, 4U);
}

TEST_F(BagMapTest, MovesRepeatedTimesAndKeepsConnectionsOfOneTopicApart) {
  const std::string chunk =
      chunk_of(text_connection(0) + text_connection(7) + text_message(0, 10, "a") +
               text_message(0, 10, "b") + text_message(7, 10, "c"));
  const auto contents =
      read_all(write(bag_header(1, 2, 1) + chunk + index_of(0, {10, 10}) + index_of(7, {10}) +
                     text_connection(0) + text_connection(7) + chunk_info(1, 10, 10)));
  ASSERT_OK(contents);
  EXPECT_THAT(texts(*contents), ElementsAre("a", "b", "c"));
  EXPECT_EQ(to_ns(contents->updates[1].time), 10'000'000'001);
  EXPECT_EQ(contents->updates[2].entity.to_string(), "Data/rosbag/robot/text_2");
  EXPECT_EQ(contents->report.not_carried.at("repeated times, moved by 1 ns"), 1U);
}

// As a recorder leaves it that was killed: no index, messages of the last chunk outside of it.
TEST_F(BagMapTest, ReadsABagWithoutAnIndex) {
  const std::string chunk = chunk_of(text_connection(0) + text_message(0, 10, "a"));
  const auto contents = read_all(write(bag_header(0, 0, 0) + chunk + text_message(0, 20, "b")));
  ASSERT_OK(contents);
  EXPECT_THAT(texts(*contents), ElementsAre("a", "b"));
  EXPECT_THAT(contents->report.truncated_at, HasSubstr("needs an index"));
  EXPECT_THAT(contents->report.truncated_at, HasSubstr("file.bag', offset "));
}

TEST_F(BagMapTest, KeepsMessagesWhoseDefinitionItCannotReadAsBytes) {
  const auto contents =
      read_all(write(bag_header(1, 1, 0) + text_connection(0, "/text", "no definition") +
                     text_message(0, 10, "a")));
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 1U);
  EXPECT_EQ(contents->updates[0].instances[0].data,
            idf::Data(idf::Dict{{"type", "std_msgs/String"},
                                {"bytes", idf::NdArray::take<uint8_t>({5}, {1, 0, 0, 0, 'a'})}}));
  EXPECT_NE(idf::Data(contents->streams[0].attributes).at("kept_as_bytes"), nullptr);
}

TEST_F(BagMapTest, NamesWhatIsNoBag) {
  EXPECT_FAILS(open(scratch_ / "none"), StatusCode::kNotFound, "none");
  EXPECT_FAILS(open(write("")), StatusCode::kDataLoss, "has 0 bytes");
  EXPECT_FAILS(open(write("#ROSB")), StatusCode::kDataLoss, "has 5 bytes");
  EXPECT_FAILS(open(write("#ROSBAG V1.2\nabc")), StatusCode::kInvalidArgument, "needs 2.0");
  EXPECT_FAILS(open(write("\x89MCAP0\r\n and more")), StatusCode::kInvalidArgument, "offset 0");
  EXPECT_FAILS(open(write(std::string(kMagic) + text_connection(0))), StatusCode::kDataLoss,
               "offset 13: needs a bag header");
  EXPECT_FAILS(open(write(std::string(kMagic) + record_of(Opcode::kBagHeader,
                                                          {{"index_pos", number_field(uint64_t{0})},
                                                           {"conn_count", number_field(0)},
                                                           {"chunk_count", number_field(0)},
                                                           {"encryptor", "rosbag/AesCbcEncryptor"}},
                                                          ""))),
               StatusCode::kInvalidArgument, "encrypted");
}

TEST_F(BagMapTest, SaysWhereAChunkIsDamaged) {
  const std::string begin = bag_header(1, 1, 2);
  const std::string damaged = record_of(
      Opcode::kChunk, {{"compression", "bz2"}, {"size", number_field(uint32_t{100})}}, "BZh9abcd");
  const std::string whole = chunk_of(text_connection(0) + text_message(0, 10, "a"));
  const auto contents =
      read_all(write(begin + damaged + index_of(0, {5, 6}) + whole + index_of(0, {10}) +
                     text_connection(0) + chunk_info(1, 5, 6) + chunk_info(2, 10, 10)));
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report.damaged, 2U);
  EXPECT_THAT(contents->report.not_carried,
              Contains(Key(HasSubstr(fmt::format("offset {}: bz2", begin.size())))));
  EXPECT_THAT(texts(*contents), ElementsAre("a"));
}

TEST_F(BagMapTest, ReadsWhatEndsEarlyAsFarAsItGoes) {
  const std::string file = small_bag();
  const size_t begin = bag_header(0, 1, 2).size();
  size_t last = 0;
  for (size_t size = 0; size < file.size(); ++size) {
    const auto contents = read_all(write(file.substr(0, size)));
    if (size < begin) {
      EXPECT_THAT(status_of(contents).message(), HasSubstr("file.bag'")) << size;
      continue;
    }
    ASSERT_OK(contents);
    EXPECT_THAT(contents->report.truncated_at, HasSubstr("file.bag', offset ")) << size;
    EXPECT_GE(contents->updates.size(), last) << size;
    last = contents->updates.size();
  }
  EXPECT_EQ(last, 4U);
}

TEST_F(BagMapTest, NeverCrashesForADamagedByte) {
  const std::string file = small_bag();
  for (size_t at = 0; at < file.size(); ++at) {
    for (const char flip : {'\x01', '\x55', '\xff'}) {
      std::string damaged = file;
      damaged[at] = static_cast<char>(damaged[at] ^ flip);
      const auto contents = read_all(write(damaged));
      if (!contents.ok()) {
        EXPECT_THAT(contents.status().message(), HasSubstr("file.bag', offset ")) << at;
        continue;
      }
      // What is lost is told.
      const ReadingReport& report = contents->report;
      EXPECT_TRUE(contents->updates.size() == 4 || !report.not_carried.empty() ||
                  !report.truncated_at.empty())
          << at;
    }
  }
}

TEST_F(BagMapTest, NeverCrashesForADamagedByteOfCompressedChunks) {
  for (const char* name : {"bz2.bag", "lz4.bag"}) {
    const auto bytes = read_file(golden(name));
    ASSERT_OK(bytes);
    const std::string file(as_text(bytes->bytes()));
    for (size_t at = 0; at < file.size(); at += 37) {
      std::string damaged = file;
      damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
      const auto contents = read_all(write(damaged));
      if (contents.ok()) continue;
      EXPECT_THAT(contents.status().message(), HasSubstr("offset ")) << at;
    }
  }
}

TEST_F(BagMapTest, AllocatesNothingForHostileLengths) {
  const std::string file = small_bag();
  for (const uint32_t hostile : {~uint32_t{0}, uint32_t{1} << 31, uint32_t{1} << 29}) {
    for (size_t at = kMagic.size(); at + sizeof(hostile) <= file.size(); ++at) {
      std::string damaged = file;
      std::memcpy(damaged.data() + at, &hostile, sizeof(hostile));
      const auto contents = read_all(write(damaged));
      if (contents.ok()) continue;
      EXPECT_THAT(contents.status().message(), HasSubstr("offset ")) << at;
    }
  }
  // Claims that compressed bytes cannot keep.
  for (const char* compression : {"none", "bz2", "lz4", "other"}) {
    const std::string claim =
        record_of(Opcode::kChunk,
                  {{"compression", compression}, {"size", number_field(uint32_t{1} << 29)}}, "abc");
    const auto contents = read_all(write(bag_header(1, 0, 1) + claim + chunk_info(1, 1, 1)));
    ASSERT_OK(contents);
    EXPECT_EQ(contents->report.damaged, 1U) << compression;
  }
}

}  // namespace
}  // namespace engram::datasets::rosbag
