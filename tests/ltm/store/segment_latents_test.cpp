// SPDX-License-Identifier: Apache-2.0
// Latents in segment files: written, read, and from hostile columns.
#include "ltm/store/segment_latents.h"

#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class SegmentLatents : public ::testing::Test {
 protected:
  SegmentLatents() : file_(scratch_ / "l.h5"), group_(segment_group(example_entity())) {}

  SegmentInfo write(const std::vector<LatentSnapshot>& snapshots) {
    std::filesystem::remove(file_);
    auto info = write_latent_segment(file_, example_entity(), snapshots);
    EXPECT_OK(info);
    return info.value_or(SegmentInfo());
  }

  std::vector<LatentSnapshot> read() {
    std::vector<LatentSnapshot> found;
    const auto reader = *SegmentReader::open(file_);
    const auto spans = *reader->index(example_entity());
    for (const RowSpan& span : spans) {
      auto snapshot = reader->read_latent(example_entity(), span);
      EXPECT_OK(snapshot);
      found.push_back(std::move(snapshot).value_or(LatentSnapshot()));
    }
    return found;
  }

  void expect_round_trip(const std::vector<LatentSnapshot>& expected) {
    write(expected);
    const auto found = read();
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].time, expected[i].time);
      ASSERT_EQ(found[i].instances.size(), expected[i].instances.size());
      for (size_t k = 0; k < found[i].instances.size(); ++k)
        EXPECT_TRUE(is_equal(found[i].instances[k].latent, expected[i].instances[k].latent)) << i;
    }
  }

  /// Bytes of codes in the file.
  [[nodiscard]] uint64_t code_bytes() const {
    const auto info = h5::File::open(file_)->info(group_ + "/latent/bytes");
    EXPECT_OK(info);
    return info->count();
  }

  [[nodiscard]] bool has(const std::string& dataset) const {
    return *h5::File::open(file_)->exists(group_ + "/latent/" + dataset);
  }

  ScratchDirectory scratch_;
  std::filesystem::path file_;
  std::string group_;
};

TEST_F(SegmentLatents, StoreTheBytesOfABlockOnce) {
  expect_round_trip(example_block_latents(0, 4 * kExampleBlockRows, 2));
  EXPECT_EQ(code_bytes(), 4 * kExampleBlockBytes);
}

TEST_F(SegmentLatents, CountABlockOnce) {
  auto alone = example_block_latents(0, 10 * kExampleBlockRows, 2);
  const uint64_t of_blocks = write(alone).entities[0].stored_bytes;
  for (LatentSnapshot& snapshot : alone) snapshot.instances[0].latent.place = {};
  const uint64_t of_rows = write(alone).entities[0].stored_bytes;
  EXPECT_GT(of_rows, of_blocks + 45 * kExampleBlockBytes);
}

TEST_F(SegmentLatents, ShareTheBytesOfABlockWhereTheyAreReadInOrder) {
  write(example_block_latents(0, 3 * kExampleBlockRows, 2));
  const auto found = read();
  for (size_t i = 0; i < found.size(); ++i) {
    const size_t first = i / kExampleBlockRows * kExampleBlockRows;
    EXPECT_EQ(found[i].instances[0].latent.code.data(),
              found[first].instances[0].latent.code.data());
  }
}

TEST_F(SegmentLatents, GiveBackAnyRowByItself) {
  const auto expected = example_block_latents(0, 8 * kExampleBlockRows, 2);
  write(expected);
  const auto reader = *SegmentReader::open(file_);
  RandomValues random(3);
  for (int i = 0; i < 200; ++i) {
    const size_t row = random.below(expected.size());
    const auto found = reader->read_latent(example_entity(), {expected[row].time, row, 1});
    ASSERT_OK(found);
    EXPECT_TRUE(is_equal(found->instances[0].latent, expected[row].instances[0].latent)) << row;
  }
}

TEST_F(SegmentLatents, NeedNoColumnsWhereEachIsAlone) {
  expect_round_trip(example_latents(0, 20, 2));
  for (const char* name : {"holder", "index", "count"}) EXPECT_FALSE(has(name));
  expect_round_trip(example_block_latents(0, 20, 2));
  for (const char* name : {"holder", "index", "count"}) EXPECT_TRUE(has(name));
}

TEST_F(SegmentLatents, MixBlocksWithLatentsThatAreAlone) {
  auto mixed = example_latents(0, 5, 2);
  mixed[1].instances[0].latent.code = Buffer();
  for (const LatentSnapshot& each : example_block_latents(6, 21, 2)) mixed.push_back(each);
  for (const LatentSnapshot& each : example_latents(30, 33, 2)) mixed.push_back(each);
  expect_round_trip(mixed);
}

TEST_F(SegmentLatents, KeepBytesAndPlacesWhereRowsOfABlockAreMissing) {
  auto left = example_block_latents(0, 4 * kExampleBlockRows, 2);
  std::erase_if(left, [](const LatentSnapshot& snapshot) {
    const int64_t index = (snapshot.time - example_time(0)) / (example_time(1) - example_time(0));
    return index % 4 == 0 || (index >= 12 && index < 18);
  });
  expect_round_trip(left);
  EXPECT_EQ(code_bytes(), 3 * kExampleBlockBytes);
}

TEST_F(SegmentLatents, OfOneBlockFromTwoFilesShareItsBytesInOne) {
  const auto all = example_block_latents(0, 2 * kExampleBlockRows, 2);
  write({all.begin(), all.begin() + 8});
  auto joined = read();
  write({all.begin() + 8, all.end()});
  for (LatentSnapshot& snapshot : read()) joined.push_back(std::move(snapshot));
  expect_round_trip(joined);
  EXPECT_EQ(code_bytes(), 2 * kExampleBlockBytes);
}

TEST_F(SegmentLatents, OfInstancesInBlocksOfTheirOwnAreStoredOnce) {
  auto snapshots = example_block_latents(0, 2 * kExampleBlockRows, 2);
  const auto others = example_block_latents(100 * kExampleBlockRows, 102 * kExampleBlockRows, 2);
  for (size_t i = 0; i < snapshots.size(); ++i)
    snapshots[i].instances.push_back(others[i].instances[0]);
  expect_round_trip(snapshots);
  EXPECT_EQ(code_bytes(), 4 * kExampleBlockBytes);
}

TEST_F(SegmentLatents, AreRefusedAtPlacesThatNoBlockHas) {
  for (const GroupPlace place : {GroupPlace{0, 0}, GroupPlace{1, 1}, GroupPlace{6, 6},
                                 GroupPlace{0, kMaxGroupImages + 1}, GroupPlace{UINT32_MAX, 6}}) {
    auto snapshots = example_block_latents(0, 3, 2);
    snapshots[1].instances[0].latent.place = place;
    EXPECT_FAILS(write_latent_segment(file_, example_entity(), snapshots),
                 StatusCode::kInvalidArgument, "row 1: found place");
    std::filesystem::remove(file_);
  }
  auto snapshots = example_block_latents(0, 3, 2);
  snapshots[2].instances[0].latent.code = Buffer();
  EXPECT_FAILS(write_latent_segment(file_, example_entity(), snapshots),
               StatusCode::kInvalidArgument, "needs bytes");
}

/// Columns of latents written by hand.
class HostileLatents : public ::testing::Test {
 protected:
  struct Columns {
    std::vector<uint64_t> holder;
    std::vector<uint32_t> index, count;
    /// Of the rows' own codes; empty where it is 0.
    std::vector<uint64_t> bytes;
  };

  /// Five rows: a block of three, one alone, the beginning of a block.
  static Columns valid() {
    return {{0, 0, 0, 3, 4}, {0, 1, 3, 0, 0}, {4, 4, 4, 1, 2}, {9, 0, 0, 5, 7}};
  }

  std::filesystem::path write(const Columns& columns, const std::string& without = "") {
    const auto path = scratch_ / ("s" + std::to_string(++files_) + ".h5");
    auto file = *h5::File::create(path);
    BlobColumn blobs;
    for (const uint64_t bytes : columns.bytes)
      blobs.append(std::vector<std::byte>(bytes, std::byte{7}));
    EXPECT_OK(blobs.write(file, "/latent"));
    if (without != "holder") EXPECT_OK(write_column(file, "/latent/holder", columns.holder));
    if (without != "index") EXPECT_OK(write_column(file, "/latent/index", columns.index));
    if (without != "count") EXPECT_OK(write_column(file, "/latent/count", columns.count));
    EXPECT_OK(file.close());
    return path;
  }

  Result<Latent> read(const Columns& columns, uint64_t row, const std::string& without = "") {
    const auto path = write(columns, without);
    SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
    return LatentCodeReader(source).read("/latent", row);
  }

  ScratchDirectory scratch_;
  int files_ = 0;
};

TEST_F(HostileLatents, AreReadWhereTheyAreValid) {
  const std::vector<size_t> sizes{9, 9, 9, 5, 7};
  const Columns columns = valid();
  for (uint64_t row = 0; row < sizes.size(); ++row) {
    const auto found = read(columns, row);
    ASSERT_OK(found);
    EXPECT_EQ(found->code.size(), sizes[row]);
    EXPECT_EQ(found->place.index, columns.index[row]);
    EXPECT_EQ(found->place.count, columns.count[row]);
  }
  EXPECT_FAILS(read(columns, 5), StatusCode::kDataLoss, "needs row 5");
}

TEST_F(HostileLatents, AreRefusedWhereTheHolderIsNone) {
  Columns columns = valid();
  columns.holder[1] = 2;
  EXPECT_FAILS(read(columns, 1), StatusCode::kDataLoss, "is held by row 2");
  columns.holder[1] = UINT64_MAX;
  EXPECT_FAILS(read(columns, 1), StatusCode::kDataLoss, "row 1, place 1 of 4");
  columns = valid();
  columns.holder[2] = 1;
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "which is held by row 0");
  columns = valid();
  columns.holder[3] = 0;
  EXPECT_FAILS(read(columns, 3), StatusCode::kDataLoss, "is held by row 0");
  columns = valid();
  columns.bytes[0] = 0;
  EXPECT_FAILS(read(columns, 0), StatusCode::kDataLoss, "no bytes");
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "row 0 holds a block");
}

TEST_F(HostileLatents, AreRefusedAtPlacesThatNoBlockHas) {
  for (const GroupPlace place : {GroupPlace{0, 0}, GroupPlace{4, 4}, GroupPlace{1, 1},
                                 GroupPlace{1, kMaxGroupImages + 1}, GroupPlace{0, UINT32_MAX}}) {
    Columns columns = valid();
    columns.index[1] = place.index;
    columns.count[1] = place.count;
    EXPECT_FAILS(read(columns, 1), StatusCode::kDataLoss, "needs one of at most 1024");
  }
}

TEST_F(HostileLatents, AreRefusedWherePlacesOfABlockDoNotIncrease) {
  Columns columns = valid();
  columns.index[2] = 1;
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "place 1 of 4 behind place 1 of 4");
  columns.index[2] = 0;
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "place 0 of 4 behind place 1 of 4");
  columns = valid();
  columns.count[2] = 5;
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "place 3 of 5 behind place 1 of 4");
}

TEST_F(HostileLatents, AreRefusedFarFromTheirBlock) {
  const size_t rows = kMaxBlockStride + 3;
  Columns columns{{},
                  std::vector<uint32_t>(rows, 0),
                  std::vector<uint32_t>(rows, 1),
                  std::vector<uint64_t>(rows, 3)};
  for (uint64_t i = 0; i < rows; ++i) columns.holder.push_back(i);
  columns.count[0] = 2;
  for (const uint64_t row : {kMaxBlockStride, kMaxBlockStride + 1}) {
    Columns far = columns;
    far.holder[row] = 0;
    far.index[row] = 1;
    far.count[row] = 2;
    if (row == kMaxBlockStride)
      EXPECT_OK(read(far, row));
    else
      EXPECT_FAILS(read(far, row), StatusCode::kDataLoss, "among the 64 before it");
  }
}

TEST_F(HostileLatents, AreRefusedWhereColumnsAreShortOrMissing) {
  Columns columns = valid();
  columns.holder.resize(3);
  EXPECT_FAILS(read(columns, 4), StatusCode::kDataLoss, "needs row 4");
  columns = valid();
  columns.index.resize(2);
  EXPECT_FAILS(read(columns, 2), StatusCode::kDataLoss, "has 2 rows, needs row 2");
  EXPECT_FAILS(read(valid(), 2, "index"), StatusCode::kDataLoss, "is missing");
  EXPECT_FAILS(read(valid(), 2, "count"), StatusCode::kDataLoss, "is missing");
}

TEST_F(HostileLatents, NeverGiveAPlaceOutsideOfABlock) {
  RandomValues random(11);
  int good = 0;
  for (int round = 0; round < 300; ++round) {
    Columns columns;
    for (uint64_t i = 0; i < 8; ++i) {
      columns.holder.push_back(random.below(i + (random.below(8) == 0 ? 3 : 1)));
      columns.index.push_back(static_cast<uint32_t>(random.below(4)));
      columns.count.push_back(static_cast<uint32_t>(random.below(5)));
      columns.bytes.push_back(random.below(3));
    }
    const auto path = write(columns);
    SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
    LatentCodeReader reader(source);
    for (uint64_t row = 0; row < 10; ++row) {
      const auto found = reader.read("/latent", row);
      if (!found.ok()) continue;
      ++good;
      EXPECT_LT(found->place.index, found->place.count);
      EXPECT_TRUE(found->place.count == 1 || !found->code.empty());
    }
    std::filesystem::remove(path);
  }
  EXPECT_GT(good, 100);
}

}  // namespace
}  // namespace engram::ltm
