// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/ordered_messages.h"

#include "tests/datasets/mcap/example_files.h"

namespace engram::datasets::mcap {
namespace {

/// Forty messages in chunks of four, each of which spans nearly the whole recording.
void write_overlapping(const std::filesystem::path& path) {
  constexpr uint64_t kChunks = 10;
  auto writer = McapWriter::create(path, {.chunk_bytes = 4 * 31 + 60, .compression = ""}).value();
  writer.add(ChannelRecord{1, 0, "a", "x", {}});
  for (uint64_t chunk = 0; chunk < kChunks; ++chunk)
    for (uint64_t i = 0; i < 4; ++i)
      ASSERT_OK(writer.write(MessageRecord{1, 0, i * kChunks + chunk, 0, {}}));
  ASSERT_OK(writer.close());
}

TEST(OrderedMessages, ReadsAgainWhatMemoryDoesNotHold) {
  const ScratchDirectory scratch;
  write_overlapping(scratch / "file.mcap");
  auto file = FileWindow::open(scratch / "file.mcap");
  ASSERT_OK(file);
  ReadingReport report;
  const auto map = map_file(*file, report);
  ASSERT_OK(map);
  ASSERT_GT(map->regions.size(), 4U);
  for (const uint64_t memory_bytes : {uint64_t{1}, uint64_t{500}, OrderedRegions::kMemoryBytes}) {
    OrderedMessages messages(*file, map->regions, memory_bytes);
    for (uint64_t i = 0; i < 40; ++i) {
      const auto message = messages.next(report);
      ASSERT_OK(message);
      ASSERT_TRUE(message->has_value());
      EXPECT_EQ((*message)->log_time, i) << memory_bytes;
    }
    const auto end = messages.next(report);
    ASSERT_OK(end);
    EXPECT_FALSE(end->has_value());
  }
  EXPECT_EQ(report, ReadingReport{});
}

}  // namespace
}  // namespace engram::datasets::mcap
