// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/rewrite.h"

#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using Content = std::map<Time, Snapshot>;

class RewriteTest : public ::testing::Test {
 protected:
  RewriteTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  /// Writes the examples of these indices, the value that of `seed`, and seals them.
  void seal(std::initializer_list<int64_t> indices, int64_t seed = 0,
            const std::string& name = "cam") {
    const auto writer = *StoreWriter::open(store_, {});
    for (const int64_t index : indices) {
      Snapshot snapshot = example_snapshot(example_entity(name), index + seed);
      snapshot.time = example_time(index);
      PackedSnapshot packed = pack_snapshot(snapshot);
      packed.dropped = 2;
      packed.dropped_bytes = 20;
      ASSERT_OK(writer->append({packed}, nullptr));
      (name == "cam" ? content_ : other_)[snapshot.time] = snapshot;
    }
    ASSERT_OK(writer->seal());
  }

  void publish_latents(int64_t first, int64_t end, int version,
                       const MemoryId& entity = example_entity()) {
    const auto model = *temporary_file(store_, ".model");
    overwrite_file(model, as_bytes("weights"));
    ASSERT_OK(publish_model(store_, entity, version, model, example_latents(first, end, version)));
  }

  void expect_content(const Content& expected, const std::string& name = "cam") {
    const auto reader = *StoreReader::open(store_);
    const auto found = read_all(*reader, example_entity(name));
    ASSERT_OK(found);
    ASSERT_EQ(found->size(), expected.size());
    size_t i = 0;
    for (const auto& [time, snapshot] : expected) EXPECT_EQ((*found)[i++], snapshot);
  }

  EntitySummary summary(const std::string& name = "cam") {
    return *(*StoreReader::open(store_))->summary(example_entity(name));
  }

  [[nodiscard]] size_t files_in(const char* folder) const {
    size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(store_ / folder))
      ++count;
    return count;
  }

  void forget_examples(std::initializer_list<int64_t> indices, ForgetSet& gone) {
    for (const int64_t index : indices) {
      gone[example_entity()].insert(example_time(index));
      content_.erase(example_time(index));
    }
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  Content content_;
  Content other_;
};

TEST_F(RewriteTest, CompactionJoinsSegmentsAndKeepsEverything) {
  seal({0, 1, 2});
  seal({3, 4}, 0, "other");
  seal({5, 1, 7}, 100);
  seal({6});
  const EntitySummary before = summary();
  const auto report = compact(store_, {});
  ASSERT_OK(report);
  EXPECT_EQ(report->segments_before, 4u);
  EXPECT_EQ(report->segments_after, 1u);
  EXPECT_GT(report->freed_bytes(), 0u);
  EXPECT_EQ(files_in("segments"), 1u);
  expect_content(content_);
  expect_content(other_, "other");
  const EntitySummary after = summary();
  EXPECT_EQ(after.offered, before.offered);
  EXPECT_EQ(after.raw_bytes, before.raw_bytes);
  EXPECT_EQ(after.offered_bytes, before.offered_bytes);
  const auto again = compact(store_, {});
  ASSERT_OK(again);
  EXPECT_EQ(again->segments_before, 0u) << "there is nothing left to join";
}

TEST_F(RewriteTest, CompactionHeedsTheSizeOfSegments) {
  for (int64_t i = 0; i < 6; ++i) seal({2 * i, 2 * i + 1});
  ASSERT_OK(compact(store_, {.segment_snapshots = 4}));
  EXPECT_EQ(files_in("segments"), 3u);
  expect_content(content_);
}

TEST_F(RewriteTest, CompactionDoesNotJoinAcrossLatents) {
  seal({0, 1, 2});
  publish_latents(0, 3, 1);
  seal({1}, 50);
  ASSERT_OK(compact(store_, {}));
  expect_content(content_);
  const auto reader = *StoreReader::open(store_);
  const auto& entries = **reader->index(example_entity());
  EXPECT_TRUE(entries[0].latent.has_value());
  EXPECT_FALSE(entries[1].latent.has_value()) << "the latents are of what the update replaced";
  EXPECT_FALSE((*(*reader->timeline(example_entity()))->at_or_after(example_time(1)))->latent);
}

TEST_F(RewriteTest, CompactionKeepsSegmentsOfDifferentTypesApart) {
  for (int64_t i = 0; i < 2; ++i) {
    seal({i});
    const auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->declare(example_entity().parent(),
                              i == 0 ? idf::Type::string() : idf::Type::int32()));
  }
  seal({2});
  ASSERT_OK(compact(store_, {}));
  EXPECT_EQ(files_in("segments"), 3u);
  expect_content(content_);
}

TEST_F(RewriteTest, ForgetsInEveryFormAndCountsIt) {
  seal({0, 1, 2, 3});
  seal({4, 5, 2}, 100);
  publish_latents(0, 4, 1);
  const EntitySummary before = summary();
  ForgetSet gone;
  forget_examples({1, 2, 5}, gone);
  gone[example_entity()].insert(example_time(77));
  gone[example_entity("nobody")].insert(example_time(1));
  const auto report = forget_snapshots(store_, gone);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 3u);
  expect_content(content_);
  const EntitySummary after = summary();
  EXPECT_EQ(after.snapshots, 3u);
  EXPECT_EQ(after.latent_snapshots, 2u);
  EXPECT_EQ(after.forgotten.snapshots, 3u);
  EXPECT_EQ(after.offered, before.offered);
  EXPECT_GT(after.forgotten.raw_bytes, 0u);
}

TEST_F(RewriteTest, ForgetsInMoreSegmentsThanStayOpen) {
  constexpr int kEntities = 66;
  ForgetSet gone;
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int e = 0; e < kEntities; ++e)
      for (int64_t i = 0; i < 2; ++i)
        ASSERT_OK(writer->append({packed_example(i, example_entity(std::to_string(e)))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  for (int e = 0; e < kEntities; ++e) {
    const auto entity = example_entity(std::to_string(e));
    publish_latents(0, 2, 1, entity);
    gone[entity].insert(example_time(1));
  }
  const auto report = forget_snapshots(store_, gone);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, static_cast<uint64_t>(kEntities));
  const auto reader = *StoreReader::open(store_);
  for (int e = 0; e < kEntities; ++e) {
    const auto& entries = **reader->index(example_entity(std::to_string(e)));
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_TRUE(entries[0].recorded && entries[0].latent);
  }
}

TEST_F(RewriteTest, ForgetsInMoreSegmentsOfOneTimeThanStayOpen) {
  for (int i = 0; i < 66; ++i) seal({0, 1}, i);
  ForgetSet gone;
  forget_examples({0}, gone);
  const auto report = forget_snapshots(store_, gone);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 1u);
  expect_content(content_);
}

TEST_F(RewriteTest, ForgettingTheLastOfAModelTakesTheModel) {
  seal({0, 1, 2});
  publish_latents(0, 3, 1);
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  ForgetSet gone;
  forget_examples({0, 1, 2}, gone);
  const auto report = forget_snapshots(store_, gone);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 3u);
  const auto reader = *StoreReader::open(store_);
  EXPECT_TRUE(reader->manifest().models.empty());
  EXPECT_EQ(files_in("models"), 0u);
  EXPECT_EQ(reader->manifest().forgotten.at(example_entity()).snapshots, 3u);
}

TEST_F(RewriteTest, LeavesSegmentsAloneThatHoldNothingOfIt) {
  seal({0, 4});
  seal({1, 2});
  const auto before = (*StoreReader::open(store_))->manifest().segments;
  ForgetSet gone;
  gone[example_entity()].insert(example_time(3));
  ASSERT_OK(forget_snapshots(store_, gone));
  const auto after = (*StoreReader::open(store_))->manifest().segments;
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].file, before[i].file);
}

TEST_F(RewriteTest, LeavesNoFileBehindWhereItCannotPublish) {
  seal({0, 1, 2});
  publish_latents(0, 3, 1);
  // A directory lies where the next segment is to go.
  const uint64_t next = read_manifest(store_)->next_segment;
  std::filesystem::create_directories(store_ / fmt::format("segments/{:06}.h5/in", next));
  const ForgetSet gone{{example_entity(), {example_time(1)}}};
  EXPECT_FAILS(forget_snapshots(store_, gone), StatusCode::kUnavailable, "");
  EXPECT_EQ(files_in("tmp"), 0u) << "of latents";
  ASSERT_OK(edit_manifest(store_, [](Manifest& manifest) {
    std::erase_if(manifest.segments,
                  [](const auto& segment) { return segment.kind == SegmentKind::kLatent; });
    return Status();
  }));
  EXPECT_FAILS(forget_snapshots(store_, gone), StatusCode::kUnavailable, "");
  EXPECT_EQ(files_in("tmp"), 0u) << "of what was recorded";
}

TEST_F(RewriteTest, RefusesToRewriteWhatIsDamaged) {
  seal({0, 1, 2});
  seal({3});
  const auto file = store_ / "segments/000001.h5";
  const Buffer whole = *read_file(file);
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  for (size_t i = 3000; i < damaged.size(); i += 64) damaged[i] ^= std::byte{0xff};
  overwrite_file(file, damaged);
  EXPECT_FAILS(compact(store_, {}).status(), StatusCode::kDataLoss, "000001.h5");
  EXPECT_EQ(files_in("segments"), 2u);
  EXPECT_EQ(files_in("tmp"), 0u);
}

}  // namespace
}  // namespace engram::ltm
