// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_reader.h"

#include <atomic>
#include <thread>

#include "ltm/core/file.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class StoreReaderTest : public ::testing::Test {
 protected:
  StoreReaderTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(StoreReaderTest, OfAnEmptyStoreKnowsNothing) {
  const auto reader = StoreReader::open(store_);
  ASSERT_OK(reader);
  EXPECT_TRUE((*reader)->entities().empty());
  EXPECT_FAILS((*reader)->index(example_entity()), StatusCode::kNotFound, "it has: none");
  EXPECT_FAILS(StoreReader::open(scratch_ / "nothing"), StatusCode::kNotFound, "does not exist");
}

TEST_F(StoreReaderTest, NamesTheEntitiesThatThereAre) {
  const auto writer = *StoreWriter::open(store_, {});
  ASSERT_OK(writer->append({packed_example(0, example_entity("b"))}, nullptr));
  ASSERT_OK(writer->seal());
  ASSERT_OK(writer->append(
      {packed_example(0, example_entity("a")), packed_example(1, example_entity("b"))}, nullptr));
  const auto reader = StoreReader::open(store_);
  EXPECT_EQ((*reader)->entities(), (std::vector{example_entity("a"), example_entity("b")}));
  EXPECT_FAILS((*reader)->summary(example_entity("c")), StatusCode::kNotFound,
               "Vision/RGB/head/a, Vision/RGB/head/b");
}

TEST_F(StoreReaderTest, SeesOneGenerationOfTheStore) {
  const auto writer = *StoreWriter::open(store_, {});
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  const auto reader = *StoreReader::open(store_);
  ASSERT_OK(writer->append({packed_example(1)}, nullptr));
  ASSERT_OK(writer->seal());
  const auto found = read_all(*reader, example_entity());
  ASSERT_OK(found);
  EXPECT_EQ(found->size(), 1u);
}

TEST_F(StoreReaderTest, ReadsValuesWithoutTheirImages) {
  const auto writer = *StoreWriter::open(store_, {});
  Snapshot snapshot = example_snapshot(example_entity(), 0);
  snapshot.instances[0].data =
      idf::Dict{{"image", example_image(16, 16, 3, 1)}, {"number", int64_t{7}}};
  ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
  ASSERT_OK(writer->seal());
  const auto reader = *StoreReader::open(store_);
  const auto index = reader->index(example_entity());
  ASSERT_OK(index);
  const auto whole = reader->read_packed(example_entity(), (*index)->front());
  const auto values = reader->read_values(example_entity(), (*index)->front());
  ASSERT_OK(whole);
  ASSERT_OK(values);
  ASSERT_EQ(values->instances.size(), whole->instances.size());
  EXPECT_FALSE(whole->instances[0].value.media.empty());
  EXPECT_TRUE(values->instances[0].value.media.empty());
  EXPECT_EQ(values->instances[0].value.rest, whole->instances[0].value.rest);
  EXPECT_EQ(values->instances[0].metadata, whole->instances[0].metadata);
}

TEST_F(StoreReaderTest, SumsUpSealedAndUnsealedSnapshots) {
  const auto writer = *StoreWriter::open(store_, {});
  uint64_t raw_bytes = 0, journal_bytes = 0;
  for (int64_t i = 0; i < 10; ++i) {
    PackedSnapshot packed = packed_example(i);
    packed.dropped = 5;
    packed.dropped_bytes = 500;
    raw_bytes += packed.raw_bytes;
    std::vector<uint64_t> bytes;
    ASSERT_OK(writer->append({packed}, &bytes));
    if (i == 5) {
      ASSERT_OK(writer->seal());
    }
    if (i > 5) journal_bytes += bytes[0];
  }
  ASSERT_OK(writer->append_dropped(example_entity(), 3, 300));
  const uint64_t segment_bytes = std::filesystem::file_size(store_ / "segments/000001.h5");
  for (const bool is_sealed : {false, true}) {
    if (is_sealed) {
      ASSERT_OK(writer->seal());
    }
    const auto reader = *StoreReader::open(store_);
    const auto summary = reader->summary(example_entity());
    ASSERT_OK(summary);
    EXPECT_EQ(summary->snapshots, 10u);
    EXPECT_EQ(summary->recorded_snapshots, 10u);
    EXPECT_EQ(summary->latent_snapshots, 0u);
    EXPECT_EQ(summary->first, example_time(0));
    EXPECT_EQ(summary->last, example_time(9));
    EXPECT_EQ(summary->raw_bytes, raw_bytes);
    EXPECT_EQ(summary->offered, 10u + 50u + 3u);
    EXPECT_EQ(summary->offered_bytes, raw_bytes + 5000 + 300);
    EXPECT_EQ(summary->model_bytes, 0u);
    const uint64_t second = std::filesystem::exists(store_ / "segments/000002.h5")
                                ? std::filesystem::file_size(store_ / "segments/000002.h5")
                                : journal_bytes;
    EXPECT_EQ(summary->stored_bytes, segment_bytes + second);
  }
}

TEST_F(StoreReaderTest, NamesTheSegmentThatIsMissing) {
  const auto writer = *StoreWriter::open(store_, {});
  ASSERT_OK(writer->append({packed_example(0)}, nullptr));
  ASSERT_OK(writer->seal());
  std::filesystem::remove(store_ / "segments/000001.h5");
  const auto reader = StoreReader::open(store_);
  EXPECT_FAILS((*reader)->index(example_entity()), StatusCode::kDataLoss, "segments/000001.h5");
}

TEST_F(StoreReaderTest, RunsBesideAWriter) {
  std::atomic<int64_t> acknowledged = 0;
  std::jthread writing([&](const std::stop_token& stop) {
    const auto writer = *StoreWriter::open(store_, {.seal_bytes = 3000});
    for (int64_t i = 0; !stop.stop_requested(); ++i) {
      EXPECT_OK(writer->append({packed_example(i)}, nullptr));
      acknowledged = i + 1;
    }
  });
  while (acknowledged == 0) std::this_thread::yield();
  for (int opened = 0; opened < 200; ++opened) {
    const int64_t before = acknowledged;
    const auto reader = StoreReader::open(store_);
    ASSERT_OK(reader);
    const auto entries = (*reader)->index(example_entity());
    ASSERT_OK(entries);
    ASSERT_GE(static_cast<int64_t>((*entries)->size()), before);
    const auto last = (*reader)->read_recorded(example_entity(), (*entries)->back());
    ASSERT_OK(last);
    EXPECT_EQ(*last,
              example_snapshot(example_entity(), static_cast<int64_t>((*entries)->size()) - 1));
  }
}

}  // namespace
}  // namespace engram::ltm
