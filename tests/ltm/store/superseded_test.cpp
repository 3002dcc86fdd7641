// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/superseded.h"

#include <gtest/gtest.h>

#include "ltm/store/publish.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class Superseded : public ::testing::Test {
 protected:
  Superseded() : store_(scratch_ / "store") {
    EXPECT_OK(create_store(store_));
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 20; ++i) EXPECT_OK(writer->append({packed_example(i)}, nullptr));
    EXPECT_OK(writer->seal());
    publish(1, 0, 20);
  }

  void publish(int version, int64_t first, int64_t end) {
    const auto model = *temporary_file(store_, ".model");
    overwrite_file(model, as_bytes("weights"));
    EXPECT_OK(publish_model(store_, example_entity(), version, model,
                            example_latents(first, end, version)));
  }

  /// Version of the model of each snapshot's latents.
  std::vector<int> versions() {
    const auto reader = *StoreReader::open(store_);
    std::vector<int> versions;
    for (const SnapshotEntry& entry : **reader->index(example_entity()))
      versions.push_back(entry.latent ? reader->read_latent(example_entity(), entry)->model_version
                                      : 0);
    return versions;
  }

  uint64_t latent_rows() {
    uint64_t rows = 0;
    for (const SegmentInfo& segment : read_manifest(store_)->segments)
      if (segment.kind == SegmentKind::kLatent) rows += segment.entities.front().rows;
    return rows;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(Superseded, GoWithTheirModelsAndNothingElse) {
  publish(2, 5, 9);
  EXPECT_EQ(latent_rows(), 24u);
  const auto before = versions();
  const auto report = remove_superseded_latents(store_, example_entity());
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 4u);
  EXPECT_EQ(latent_rows(), 20u);
  EXPECT_EQ(versions(), before);
  EXPECT_EQ(read_manifest(store_)->models.size(), 2u);
  publish(3, 0, 5);
  publish(4, 9, 20);
  ASSERT_OK(remove_superseded_latents(store_, example_entity()));
  EXPECT_EQ(latent_rows(), 20u);
  EXPECT_EQ(read_manifest(store_)->models.size(), 3u) << "v1 has nothing left";
  EXPECT_TRUE(check_store(store_, {}, {}, {})->findings.empty());
}

TEST_F(Superseded, RowsOfRecordedSegmentsGo) {
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (const int64_t i : {7, 8, 30}) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto rows = [this] {
    std::vector<uint64_t> of_segments;
    for (const SegmentInfo& segment : read_manifest(store_)->segments)
      if (segment.kind == SegmentKind::kRecorded)
        of_segments.push_back(segment.entities.front().rows);
    return of_segments;
  };
  ASSERT_EQ(rows(), (std::vector<uint64_t>{20, 3}));
  // Only segments that have one of these are looked at.
  ASSERT_OK(remove_superseded_recorded(store_, {{example_entity(), {example_time(40)}}}));
  EXPECT_EQ(rows(), (std::vector<uint64_t>{20, 3}));
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(remove_superseded_recorded(store_, {{example_entity(), {example_time(7)}}}, {},
                                       stopped.get_token())
                .status()
                .code(),
            StatusCode::kCancelled);
  ASSERT_OK(remove_superseded_recorded(store_, {{example_entity(), {example_time(7)}}}));
  EXPECT_EQ(rows(), (std::vector<uint64_t>{18, 3}));
  EXPECT_EQ(versions().size(), 21u);
  EXPECT_TRUE(check_store(store_, {}, {}, {})->findings.empty());
}

TEST_F(Superseded, AreNotThoseOfSnapshotsThatWereRecordedAnew) {
  publish(2, 0, 3);
  {
    const auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({packed_example(7)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  ASSERT_OK(remove_superseded_latents(store_, example_entity()));
  EXPECT_EQ(versions()[7], 0);
  EXPECT_EQ(latent_rows(), 20u);
}

TEST_F(Superseded, NothingHappensWhereThereAreNone) {
  const uint64_t generation = read_manifest(store_)->generation;
  const auto report = remove_superseded_latents(store_, example_entity());
  ASSERT_OK(report);
  EXPECT_EQ(report->segments_before, 0u);
  EXPECT_EQ(read_manifest(store_)->generation, generation);
  EXPECT_EQ(remove_superseded_latents(store_, example_entity("no")).status().code(),
            StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::ltm
