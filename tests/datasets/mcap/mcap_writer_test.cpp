// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_writer.h"

#include "tests/datasets/mcap/example_files.h"

namespace engram::datasets::mcap {
namespace {

class McapWriterTest : public testing::Test {
 protected:
  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "file.mcap";
};

TEST_F(McapWriterTest, WritesTheFileOfTheConformanceSuiteByteForByte) {
  auto writer = McapWriter::create(path_, {.compression = "", .has_data_checksum = false});
  ASSERT_OK(writer);
  write_example(*writer);
  const auto size = writer->close();
  ASSERT_OK(size);
  EXPECT_EQ(*size, 603U);
  EXPECT_EQ(content_of(path_), content_of(golden("OneMessage-ch-chx-mx-rch-rsh-st-sum.mcap")));
}

TEST_F(McapWriterTest, LeavesNothingWhereItIsNotClosed) {
  {
    auto writer = McapWriter::create(path_, {});
    ASSERT_OK(writer);
    write_example(*writer);
    EXPECT_FALSE(std::filesystem::exists(path_));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_F(McapWriterTest, RefusesANameThatIsTaken) {
  std::ofstream(path_) << "mine";
  EXPECT_FAILS(McapWriter::create(path_, {}), StatusCode::kAlreadyExists, "file.mcap");
  EXPECT_EQ(content_of(path_), "mine");
}

TEST_F(McapWriterTest, SplitsChunksOfEveryCompression) {
  for (const std::string compression : {"zstd", "lz4", ""}) {
    const auto path = scratch_ / ("file" + compression);
    auto writer = McapWriter::create(path, {.chunk_bytes = 1000, .compression = compression});
    ASSERT_OK(writer);
    write_example(*writer);
    const std::string data(600, 'x');
    for (uint64_t i = 0; i < 20; ++i)
      ASSERT_OK(writer->write(MessageRecord{1, 0, 10 + i, 0, as_bytes(data)}));
    ASSERT_OK(writer->close());
    const auto contents = read_all(path);
    ASSERT_OK(contents);
    EXPECT_EQ(contents->updates.size(), 21U) << compression;
    EXPECT_TRUE(contents->report.truncated_at.empty());
    EXPECT_EQ(contents->report.damaged, 0U);
    ASSERT_EQ(contents->streams.size(), 1U);
    EXPECT_EQ(contents->streams[0].values, 21U);
  }
}

}  // namespace
}  // namespace engram::datasets::mcap
