// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/file.h"
#include "tests/ltm/store/publish_fixture.h"

namespace engram::ltm {
namespace {

using DropRecorded = PublishFixture;

TEST_F(DropRecorded, DropsOnlyWhatHasLatents) {
  record(0, 6);
  record(6, 12);
  record(0, 5, example_entity("other"));
  ASSERT_OK(publish(1, example_latents(0, 9, 1)));
  const auto before = open()->summary(example_entity());
  const auto report = drop_recorded(store_, example_entity(), {});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 9u);
  EXPECT_EQ(report->kept, 3u);
  const auto reader = open();
  const auto summary = reader->summary(example_entity());
  ASSERT_OK(summary);
  EXPECT_EQ(summary->snapshots, 12u);
  EXPECT_EQ(summary->recorded_snapshots, 3u);
  EXPECT_EQ(summary->latent_snapshots, 9u);
  EXPECT_EQ(summary->raw_bytes, before->raw_bytes);
  EXPECT_EQ(summary->offered, before->offered);
  EXPECT_EQ(summary->offered_bytes, before->offered_bytes);
  const auto kept = read_all(*reader, example_entity());
  ASSERT_OK(kept);
  for (int64_t i = 9; i < 12; ++i)
    EXPECT_EQ((*kept)[static_cast<size_t>(i - 9)], example_snapshot(example_entity(), i));
  EXPECT_EQ(read_all(*reader, example_entity("other"))->size(), 5u);
  EXPECT_EQ(files_in("segments"), reader->manifest().segments.size());
  // Once more: nothing is left to drop.
  EXPECT_EQ(drop_recorded(store_, example_entity(), {})->snapshots, 0u);
}

TEST_F(DropRecorded, DropsNothingThatIsToBeKept) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  const auto report = drop_recorded(store_, example_entity(), {example_time(2), example_time(4)});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 4u);
  EXPECT_EQ(report->kept, 2u);
  const auto kept = read_all(*open(), example_entity());
  ASSERT_EQ(kept->size(), 2u);
  EXPECT_EQ((*kept)[1], example_snapshot(example_entity(), 4));
}

TEST_F(DropRecorded, DropsAWholeEntity) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  {
    const auto writer = *StoreWriter::open(store_, {});
    EXPECT_EQ(writer->last_time(example_entity()), example_time(5));
    ASSERT_OK(writer->append({packed_example(6)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto reader = open();
  const auto summary = reader->summary(example_entity());
  EXPECT_EQ(summary->snapshots, 7u);
  EXPECT_EQ(summary->recorded_snapshots, 1u);
  for (const SnapshotEntry& entry : *reader->index(example_entity()).value())
    if (entry.latent) {
      EXPECT_OK(reader->read_latent(example_entity(), entry));
    }
}

TEST_F(DropRecorded, DropsFromMoreSegmentsOfOneTimeThanStayOpen) {
  for (int i = 0; i < 66; ++i) record(0, 2);
  ASSERT_OK(publish(1, example_latents(0, 1, 1)));
  const auto report = drop_recorded(store_, example_entity(), {});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 1u);
  const auto kept = read_all(*open(), example_entity());
  ASSERT_OK(kept);
  EXPECT_EQ(*kept, std::vector<Snapshot>{example_snapshot(example_entity(), 1)});
}

TEST_F(DropRecorded, KeepsCountsOfWhatFiltersDropped) {
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 6; ++i) {
      PackedSnapshot packed = packed_example(i);
      packed.dropped = 2;
      packed.dropped_bytes = 20;
      ASSERT_OK(writer->append({packed}, nullptr));
    }
    ASSERT_OK(writer->append_dropped(example_entity(), 1, 7));
    ASSERT_OK(writer->seal());
  }
  ASSERT_OK(publish(1, example_latents(0, 4, 1)));
  const auto before = open()->summary(example_entity());
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  const auto after = open()->summary(example_entity());
  EXPECT_EQ(after->offered, 6u + 13u);
  EXPECT_EQ(after->offered, before->offered);
  EXPECT_EQ(after->offered_bytes, before->offered_bytes);
}

TEST_F(DropRecorded, DropsNothingWhereLatentsAreDamaged) {
  record(0, 100);
  record(100, 200);
  ASSERT_OK(publish(1, example_latents(0, 200, 1)));
  const auto manifest = read_manifest(store_);
  const std::filesystem::path file = store_ / manifest->segments.back().file;
  const Buffer whole = *read_file(file);
  // The codes lie as they are: the last one's bytes are found near their like.
  const LatentSnapshot last = example_latent(199, 1);
  const auto code = last.instances[0].latent.code.bytes();
  const size_t at = as_text(whole.bytes()).rfind(as_text(code));
  ASSERT_NE(at, std::string_view::npos);
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  damaged[at] ^= std::byte{1};
  ASSERT_OK(replace_file(file, damaged));
  EXPECT_FAILS(drop_recorded(store_, example_entity(), {}), StatusCode::kDataLoss, "checksum");
  EXPECT_EQ(open()->summary(example_entity())->recorded_snapshots, 200u);
}

TEST_F(DropRecorded, DropsNothingWhereTheModelIsDamaged) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  ASSERT_OK(replace_file(store_ / read_manifest(store_)->models[0].file, as_bytes("damaged")));
  EXPECT_FAILS(drop_recorded(store_, example_entity(), {}), StatusCode::kDataLoss, "checksum");
  EXPECT_EQ(open()->summary(example_entity())->recorded_snapshots, 6u);
  EXPECT_FAILS(drop_recorded(store_, example_entity("none"), {}), StatusCode::kNotFound, "none");
}

}  // namespace
}  // namespace engram::ltm
