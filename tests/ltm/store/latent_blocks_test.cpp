// SPDX-License-Identifier: Apache-2.0
// Blocks of latents in a store: published, checked, forgotten in part, coded anew, recovered.
#include "ltm/store/latent_blocks.h"

#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/recover.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_rows.h"
#include "ltm/store/store_check.h"
#include "ltm/store/superseded.h"
#include "tests/ltm/store/full_store.h"
#include "tests/ltm/store/publish_fixture.h"

namespace engram::ltm {
namespace {

class LatentBlocksTest : public PublishFixture {
 protected:
  /// Recorded snapshots [0, end) and latents of them in blocks of six; the recorded form goes.
  void make(int64_t end) {
    record(0, end);
    ASSERT_OK(publish(1, example_block_latents(0, end, 1)));
    ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  }

  Result<RewriteReport> forget(std::initializer_list<int64_t> indices) {
    TimeSet times;
    for (const int64_t index : indices) times.insert(example_time(index));
    return forget_snapshots(store_, {{example_entity(), times}});
  }

  std::map<int64_t, Latent> read() {
    std::map<int64_t, Latent> found;
    const auto reader = open();
    for (const SnapshotEntry& entry : **reader->index(example_entity())) {
      if (!entry.latent) continue;
      const auto snapshot = reader->read_latent(example_entity(), entry);
      EXPECT_OK(snapshot);
      if (snapshot.ok()) found[index_of(entry.time)] = snapshot->instances.at(0).latent;
    }
    return found;
  }

  void expect_as_published(const std::set<int64_t>& indices) {
    const auto found = read();
    ASSERT_EQ(found.size(), indices.size());
    for (const int64_t index : indices) {
      ASSERT_TRUE(found.contains(index)) << index;
      EXPECT_TRUE(is_equal(found.at(index), example_block_latent(index, 1).instances[0].latent))
          << index;
    }
    EXPECT_TRUE(check_store(store_)->is_clean());
  }

  static int64_t index_of(Time time) {
    return (to_ns(time) - kExampleStart_ns) / (to_ns(example_time(1)) - to_ns(example_time(0)));
  }

  /// The one latent segment.
  [[nodiscard]] std::filesystem::path latent_file() const {
    const Manifest manifest = *read_manifest(store_);
    for (const SegmentInfo& segment : manifest.segments)
      if (segment.kind == SegmentKind::kLatent) return store_ / segment.file;
    return {};
  }

  [[nodiscard]] h5::DatasetInfo code_bytes() const {
    return *h5::File::open(latent_file())->info(segment_group(example_entity()) + "/latent/bytes");
  }

  /// True where any file of the store has these bytes.
  [[nodiscard]] bool is_in_store(const Buffer& bytes) const {
    for (const auto& file : std::filesystem::recursive_directory_iterator(store_)) {
      if (!file.is_regular_file()) continue;
      const Buffer whole = *read_file(file.path());
      if (as_text(whole.bytes()).find(as_text(bytes.bytes())) != std::string_view::npos)
        return true;
    }
    return false;
  }
};

TEST_F(LatentBlocksTest, AreReadAsTheyWerePublished) {
  make(20);
  expect_as_published({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19});
  EXPECT_EQ(code_bytes().count(), 4 * kExampleBlockBytes);
  const auto summary = open()->summary(example_entity());
  EXPECT_EQ(summary->latent_snapshots, 20u);
  EXPECT_EQ(summary->latent_bytes, std::filesystem::file_size(latent_file()));
}

TEST_F(LatentBlocksTest, StayWholeWhereRowsAreForgotten) {
  make(18);
  const auto report = forget({2, 3, 7, 11});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 4u);
  expect_as_published({0, 1, 4, 5, 6, 8, 9, 10, 12, 13, 14, 15, 16, 17});
  EXPECT_EQ(code_bytes().count(), 3 * kExampleBlockBytes);
}

TEST_F(LatentBlocksTest, GoWithTheirLastRow) {
  make(18);
  ASSERT_OK(forget({0, 1, 2, 3, 4}));
  EXPECT_EQ(code_bytes().count(), 3 * kExampleBlockBytes);
  ASSERT_OK(forget({5}));
  EXPECT_EQ(code_bytes().count(), 2 * kExampleBlockBytes);
  EXPECT_FALSE(is_in_store(example_block_latent(0, 1).instances[0].latent.code));
  expect_as_published({6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
}

TEST_F(LatentBlocksTest, GoWhereTheyAreUnwanted) {
  record(0, 18);
  ASSERT_OK(publish(1, example_block_latents(0, 18, 1)));
  TimeSet unwanted;
  for (const int64_t index : {0, 1, 2, 3, 4, 5, 7}) unwanted.insert(example_time(index));
  const auto report = remove_latents(store_, example_entity(), unwanted);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 7u);
  EXPECT_FALSE(is_in_store(example_block_latent(0, 1).instances[0].latent.code));
  // Its other rows need the bytes of the second one.
  EXPECT_TRUE(is_in_store(example_block_latent(6, 1).instances[0].latent.code));
  expect_as_published({6, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
  EXPECT_TRUE(check_store(store_)->is_clean());
}

TEST_F(LatentBlocksTest, StayWhereSnapshotsHaveNoOtherForm) {
  make(6);
  EXPECT_FAILS(remove_latents(store_, example_entity(), {example_time(2)}),
               StatusCode::kFailedPrecondition, "has no other form than its latents");
  expect_as_published({0, 1, 2, 3, 4, 5});
}

TEST_F(LatentBlocksTest, ArePublishedWithoutWhatWasForgottenMeanwhile) {
  record(0, 12);
  const auto latents = example_block_latents(0, 12, 1);
  ASSERT_OK(forget({0, 1, 8}));
  ASSERT_OK(publish(1, latents));
  expect_as_published({2, 3, 4, 5, 6, 7, 9, 10, 11});
}

TEST_F(LatentBlocksTest, AreNotPublishedAtPlacesThatNoBlockHas) {
  record(0, 6);
  auto latents = example_block_latents(0, 6, 1);
  latents[4].instances[0].latent.place = {7, 6};
  EXPECT_FAILS(publish(1, latents), StatusCode::kInvalidArgument, "found place 7 of 6");
}

TEST_F(LatentBlocksTest, AreOfTheNewerModelWherePartsOverlap) {
  record(0, 12);
  ASSERT_OK(publish(1, example_block_latents(0, 12, 1)));
  ASSERT_OK(publish(2, example_block_latents(6, 12, 2)));
  const auto found = read();
  ASSERT_EQ(found.size(), 12u);
  for (const auto& [index, latent] : found)
    EXPECT_TRUE(
        is_equal(latent, example_block_latent(index, index < 6 ? 1 : 2).instances[0].latent))
        << index;
}

TEST_F(LatentBlocksTest, OfWhichOneIsDamagedCostOnlyItsRows) {
  make(24);
  flip_bit(latent_file(), (*code_bytes().offset + kExampleBlockBytes + 17) * 8);
  const auto checked = check_store(store_);
  EXPECT_TRUE(std::ranges::any_of(checked->findings, [](const Finding& finding) {
    return finding.what.find("fails its checksum (here and in 5 more snapshots)") !=
           std::string::npos;
  }));
  const auto report = recover_store(store_, scratch_ / "copy");
  ASSERT_OK(report);
  EXPECT_EQ(report->entities.at(example_entity()).latent, 18u);
  EXPECT_EQ(report->entities.at(example_entity()).latent_lost, 6u);
  store_ = scratch_ / "copy";
  expect_as_published({0, 1, 2, 3, 4, 5, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23});
  EXPECT_EQ(code_bytes().count(), 3 * kExampleBlockBytes);
}

TEST_F(LatentBlocksTest, AreFoundAgainWithoutAManifest) {
  make(9);
  ASSERT_OK(forget({1, 7}));
  const uint64_t bytes = open()->summary(example_entity())->latent_bytes;
  std::filesystem::remove(store_ / "MANIFEST.json");
  ASSERT_OK(recover_store(store_, scratch_ / "copy"));
  store_ = scratch_ / "copy";
  expect_as_published({0, 2, 3, 4, 5, 6, 8});
  EXPECT_EQ(open()->summary(example_entity())->latent_bytes, bytes);
}

TEST_F(LatentBlocksTest, StayWhereRecordedSegmentsAreJoined) {
  for (int64_t first = 0; first < 12; first += 3) record(first, first + 3);
  ASSERT_OK(publish(1, example_block_latents(0, 12, 1)));
  const std::filesystem::path file = latent_file();
  const auto report = compact(store_, {});
  ASSERT_OK(report);
  EXPECT_EQ(report->segments_after, 1u);
  EXPECT_EQ(latent_file(), file);
  expect_as_published({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
}

/// A latent segment of one block, with these holders.
void write_by_hand(const std::filesystem::path& path, const std::vector<uint64_t>& holders) {
  auto file = *h5::File::create(path);
  const std::string group = segment_group(example_entity());
  RowColumns rows;
  BlobColumn codes;
  RemainderColumn remainder;
  std::vector<uint32_t> indices, counts;
  for (int64_t i = 0; i < static_cast<int64_t>(holders.size()); ++i) {
    const LatentSnapshot made = example_block_latent(i, 1);
    const Latent& latent = made.instances[0].latent;
    rows.append(made.time, 0, made.instances[0].metadata);
    codes.append(i == 0 ? latent.code.bytes() : std::span<const std::byte>());
    remainder.append(latent.remainder);
    indices.push_back(latent.place.index);
    counts.push_back(latent.place.count);
  }
  EXPECT_OK(file.write_attribute("/", "format", "engram segment"));
  EXPECT_OK(file.write_attribute("/", "format_version", int64_t{1}));
  EXPECT_OK(file.write_attribute("/", "kind", "latent"));
  EXPECT_OK(rows.write(file, group));
  EXPECT_OK(file.write_attribute(group, "memory_id", example_entity().to_string()));
  EXPECT_OK(file.write_attribute(group, "model_version", int64_t{1}));
  EXPECT_OK(codes.write(file, group + "/latent"));
  EXPECT_OK(write_row_column(file, group + "/latent/holder", holders));
  EXPECT_OK(write_row_column(file, group + "/latent/index", indices));
  EXPECT_OK(write_row_column(file, group + "/latent/count", counts));
  EXPECT_OK(remainder.write(file, group + "/remainder"));
  for (const char* error : {"/error/image_mse", "/error/number_mse"})
    EXPECT_OK(write_row_column(file, group + error, std::vector<double>(holders.size(), 1.0)));
  EXPECT_OK(file.close());
}

TEST_F(LatentBlocksTest, ThatContradictThemselvesAreFoundByCheck) {
  make(6);
  const std::filesystem::path file = latent_file();
  const auto tells = [&](const std::vector<uint64_t>& holders, const std::string& what) {
    std::filesystem::remove(file);
    write_by_hand(file, holders);
    const auto report = check_store(store_);
    return std::ranges::any_of(report->findings, [&](const Finding& finding) {
      return finding.what.find(what) != std::string::npos;
    });
  };
  EXPECT_FALSE(tells({0, 0, 0, 0, 0, 0}, "held"));
  EXPECT_TRUE(tells({0, 0, 0, 5, 0, 0}, "row 3, place 3 of 6, is held by row 5"));
  EXPECT_TRUE(tells({0, 0, 2, 0, 0, 0}, "row 2 holds a block, but no bytes"));
  EXPECT_TRUE(tells({0, 0, 0, 2, 0, 0}, "row 3 is held by row 2, which is held by row 0"));
}

}  // namespace
}  // namespace engram::ltm
