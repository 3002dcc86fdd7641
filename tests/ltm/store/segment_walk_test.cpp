// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_walk.h"

#include "ltm/core/file.h"
#include "ltm/store/segment_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

/// A segment of two entities, the first with `rows` snapshots of one and two instances in turn.
SegmentInfo write_segment(const std::filesystem::path& file, int64_t rows) {
  std::map<MemoryId, RecordedEntity> entities;
  for (int64_t i = 0; i < rows; ++i) {
    PackedSnapshot snapshot = packed_example(i);
    if (i % 2 == 1) snapshot.instances.push_back(snapshot.instances[0]);
    entities[example_entity()].snapshots.push_back(std::move(snapshot));
  }
  entities[example_entity("a/b")].snapshots.push_back(packed_example(1, example_entity("a/b")));
  const auto info = write_recorded_segment(file, entities);
  EXPECT_OK(info);
  return info.value_or(SegmentInfo());
}

TEST(WalkRows, VisitsTheSnapshotsThatTheIndexHas) {
  const ScratchDirectory scratch;
  write_segment(scratch / "s.h5", 100);
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  std::vector<RowSpan> walked;
  const auto collect = [&walked](const RowSpan& span, const Status& times) {
    walked.push_back(span);
    return times;
  };
  ASSERT_OK(walk_rows(*reader, example_entity(), collect));
  const auto index = *reader->index(example_entity());
  ASSERT_EQ(walked.size(), index.size());
  for (size_t i = 0; i < index.size(); ++i) {
    EXPECT_EQ(walked[i].time, index[i].time);
    EXPECT_EQ(walked[i].first, index[i].first);
    EXPECT_EQ(walked[i].rows, index[i].rows);
  }
}

TEST(WalkRows, GoesOnBehindTimesThatCannotBeRead) {
  const ScratchDirectory scratch;
  write_segment(scratch / "s.h5", 10'000);
  const Buffer whole = *read_file(scratch / "s.h5");
  bool has_gap = false;
  // Some of these hit one of the chunks of times.
  for (size_t at = 0; at < whole.size(); at += whole.size() / 400) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[at] ^= std::byte{4};
    overwrite_file(scratch / "d.h5", damaged);
    const auto reader = SegmentReader::open(scratch / "d.h5");
    if (!reader.ok()) continue;
    uint64_t readable = 0, unreadable = 0;
    const Status status =
        walk_rows(**reader, example_entity(), [&](const RowSpan& span, const Status& times) {
          (times.ok() ? readable : unreadable) += span.rows;
          return Status();
        });
    if (!status.ok()) continue;
    EXPECT_EQ(readable + unreadable, 15'000u);
    // Where it is the index of the chunks, no time can be read.
    has_gap |= unreadable > 0 && readable > 10'000;
  }
  EXPECT_TRUE(has_gap);
}

TEST(DescribeSegment, TellsWhatTheWriterTold) {
  const ScratchDirectory scratch;
  const SegmentInfo told = write_segment(scratch / "s.h5", 50);
  const auto described = describe_segment(scratch / "s.h5");
  ASSERT_OK(described);
  EXPECT_TRUE(described->is_whole);
  EXPECT_EQ(described->info.bytes, told.bytes);
  EXPECT_EQ(described->info.checksum, told.checksum);
  ASSERT_EQ(described->info.entities.size(), 2u);
  for (const SegmentEntity& found : described->info.entities) {
    const auto of = std::ranges::find(told.entities, found.id, &SegmentEntity::id);
    ASSERT_NE(of, told.entities.end());
    EXPECT_EQ(found.snapshots, of->snapshots);
    EXPECT_EQ(found.rows, of->rows);
    EXPECT_EQ(found.first, of->first);
    EXPECT_EQ(found.last, of->last);
    EXPECT_EQ(found.raw_bytes, of->raw_bytes);
  }
}

TEST(DescribeSegment, RefusesWhatIsNone) {
  const ScratchDirectory scratch;
  EXPECT_FAILS(describe_segment(scratch / "none.h5"), StatusCode::kNotFound, "none.h5");
  overwrite_file(scratch / "text.h5", as_bytes("no segment"));
  EXPECT_FAILS(describe_segment(scratch / "text.h5"), StatusCode::kDataLoss, "text.h5");
}

}  // namespace
}  // namespace engram::ltm
