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

  Result<RewriteReport> forget(std::initializer_list<int64_t> indices,
                               const ForgetRewriteOptions& options = {}) {
    TimeSet times;
    for (const int64_t index : indices) times.insert(example_time(index));
    return forget_snapshots(store_, {{example_entity(), times}}, {}, {}, options);
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

/// Codes what stays as one block of their old places, and notes what it was asked.
class FakeRecoder {
 public:
  struct Call {
    MemoryId entity;
    int version = 0;
    std::vector<uint32_t> places;
  };

  ForgetRewriteOptions options() {
    return {[this](const MemoryId& entity, int version, std::span<const Latent> kept) {
      return recode(entity, version, kept);
    }};
  }

  std::vector<Call> calls;

 private:
  Result<std::vector<Latent>> recode(const MemoryId& entity, int version,
                                     std::span<const Latent> kept) {
    Call& call = calls.emplace_back(Call{entity, version, {}});
    for (const Latent& latent : kept) call.places.push_back(latent.place.index);
    const Buffer code = Buffer::take(call.places);
    std::vector<Latent> made;
    for (uint32_t i = 0; i < kept.size(); ++i)
      made.push_back({code, {}, {i, static_cast<uint32_t>(kept.size())}});
    return made;
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

TEST_F(LatentBlocksTest, AreCodedAnewFromWhatStays) {
  make(18);
  FakeRecoder recoder;
  ASSERT_OK(forget({2, 3, 7}, recoder.options()));
  ASSERT_EQ(recoder.calls.size(), 2u);
  EXPECT_EQ(recoder.calls[0].entity, example_entity());
  EXPECT_EQ(recoder.calls[0].version, 1);
  EXPECT_EQ(recoder.calls[0].places, (std::vector<uint32_t>{0, 1, 4, 5}));
  EXPECT_EQ(recoder.calls[1].places, (std::vector<uint32_t>{0, 2, 3, 4, 5}));
  for (const int64_t index : {0, 6})
    EXPECT_FALSE(is_in_store(example_block_latent(index, 1).instances[0].latent.code));
  const auto found = read();
  ASSERT_EQ(found.size(), 15u);
  EXPECT_EQ(found.at(4).place.index, 2u);
  EXPECT_EQ(found.at(4).place.count, 4u);
  EXPECT_EQ(found.at(4).code.size(), 4 * sizeof(uint32_t));
  EXPECT_EQ(found.at(8).place.index, 1u);
  for (const auto& [index, latent] : found)
    EXPECT_EQ(latent.remainder, example_latent(index, 1).instances[0].latent.remainder);
  // What loses nothing stays as it is.
  EXPECT_TRUE(is_equal(found.at(13), example_block_latent(13, 1).instances[0].latent));
  EXPECT_TRUE(check_store(store_)->is_clean());
}

TEST_F(LatentBlocksTest, ThatWereCutBeforeAreCodedAnewToo) {
  make(12);
  FakeRecoder recoder;
  ASSERT_OK(forget({2}));
  ASSERT_OK(forget({7}, recoder.options()));
  ASSERT_EQ(recoder.calls.size(), 2u);
  EXPECT_EQ(recoder.calls[0].places, (std::vector<uint32_t>{0, 1, 3, 4, 5}));
  // Now they are whole.
  ASSERT_OK(forget({11}, recoder.options()));
  ASSERT_EQ(recoder.calls.size(), 3u);
  EXPECT_EQ(recoder.calls[2].places, (std::vector<uint32_t>{0, 1, 2, 3}));
}

TEST_F(LatentBlocksTest, MayBeCodedAnewAsLatentsThatAreAlone) {
  make(12);
  const LatentRecoder apart = [](const MemoryId&, int, std::span<const Latent> kept) {
    std::vector<Latent> made;
    for (const Latent& latent : kept)
      made.push_back({Buffer::take(std::vector<uint32_t>{latent.place.index}), {}});
    return made;
  };
  ASSERT_OK(forget({6}, {apart}));
  EXPECT_EQ(read().at(8).place.count, 1u);
  EXPECT_EQ(read().at(8).code.bytes()[0], std::byte{2});
  EXPECT_EQ(read().at(0).place.count, 6u);
}

TEST_F(LatentBlocksTest, AreAsBeforeWhereTheRecoderFails) {
  make(12);
  const LatentRecoder fails = [](const MemoryId&, int,
                                 std::span<const Latent>) -> Result<std::vector<Latent>> {
    return data_loss("a model that forgot");
  };
  EXPECT_FAILS(forget({2}, {fails}), StatusCode::kDataLoss, "a model that forgot");
  const LatentRecoder loses = [](const MemoryId&, int, std::span<const Latent> kept) {
    return std::vector<Latent>(kept.begin(), kept.end() - 1);
  };
  EXPECT_FAILS(forget({2}, {loses}), StatusCode::kInvalidArgument, "made 4 latents of v1, needs 5");
  expect_as_published({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
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
