// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/number_blocks.h"

#include <cmath>

#include "ltm/core/file.h"
#include "ltm/store/publish.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

/// Numbers of every kind, some of which change slowly.
Snapshot numbers(int64_t index) {
  const auto x = static_cast<double>(index);
  idf::Dict joints;
  for (int i = 0; i < 12; ++i)
    joints.set(std::to_string(i), std::round(1e4 * std::sin(x / 90 + i)) / 1e4);
  idf::Dict value{{"joints", joints},
                  {"odd", index % 97 == 5 ? std::nan("") : 1 / (x + 1)},
                  {"float", static_cast<float>(x * 0.1)},
                  {"n", static_cast<int32_t>(index)},
                  {"big", INT64_MAX - index * index},
                  {"on", index % 3 == 0},
                  {"force", idf::NdArray::take<float>({2, 3}, std::vector<float>(6, float(index)))},
                  {"hollow", idf::NdArray::take<double>({3, 0}, {})},
                  {"label", "number " + std::to_string(index)}};
  return {example_entity(), example_time(index), {{value, example_metadata(index)}}};
}

Result<SegmentInfo> write(const std::filesystem::path& file, int64_t count,
                          const SealRules& rules) {
  RecordedEntity entity;
  entity.rules = rules;
  for (int64_t i = 0; i < count; ++i) entity.snapshots.push_back(pack_snapshot(numbers(i)));
  return write_recorded_segment(file, {{example_entity(), entity}});
}

void expect_numbers(const std::filesystem::path& file, int64_t count) {
  const auto reader = *SegmentReader::open(file);
  const auto spans = reader->index(example_entity());
  ASSERT_OK(spans);
  ASSERT_EQ(spans->size(), static_cast<size_t>(count));
  for (int64_t i = 0; i < count; ++i) {
    // In an order that leaves blocks and comes back.
    const int64_t at = i * 61 % count;
    const auto packed = reader->read_recorded(example_entity(), (*spans)[static_cast<size_t>(at)]);
    ASSERT_OK(packed);
    ASSERT_EQ(*unpack(*packed), numbers(at)) << at;
  }
}

TEST(NumberBlocks, GiveBackEveryBit) {
  const ScratchDirectory scratch;
  for (const int64_t count : {1, 2, 63, 64, 65, 1999}) {
    const auto file = scratch / (std::to_string(count) + ".h5");
    ASSERT_OK(write(file, count, SealRules::all_columns()));
    expect_numbers(file, count);
    EXPECT_TRUE((*SegmentReader::open(file))->forms(example_entity())->has_columns());
  }
}

TEST(NumberBlocks, AreSmallerThanPlainDatasets) {
  const ScratchDirectory scratch;
  const auto plain = write(scratch / "plain.h5", 4000, {});
  const auto blocks = write(scratch / "blocks.h5", 4000, SealRules::all_columns());
  ASSERT_OK(plain);
  ASSERT_OK(blocks);
  EXPECT_LT(blocks->bytes, plain->bytes * 7 / 10);
  EXPECT_FALSE(
      (*SegmentReader::open(scratch / "plain.h5"))->forms(example_entity())->has_columns());
}

TEST(NumberBlocks, AreChosenByPath) {
  const ScratchDirectory scratch;
  const auto rules = SealRules::create(
      {.rules = {{.path = "force", .kind = MediumKind::kNumber, .codec = "columns"}}});
  ASSERT_OK(rules);
  ASSERT_OK(write(scratch / "s.h5", 100, *rules));
  const auto file = *h5::File::open(scratch / "s.h5");
  const std::string group = segment_group(example_entity());
  EXPECT_TRUE(*file.exists(group + "/arrays/force/offset"));
  EXPECT_TRUE(file.info(group + "/columns/float64/values").ok());
  expect_numbers(scratch / "s.h5", 100);
}

TEST(NumberBlocks, OfWideRowsAreNoLargerThanIsReadAgain) {
  const ScratchDirectory scratch;
  const auto path = scratch / "wide.h5";
  const NumberTable table{idf::ElementType::kFloat32, 2, 1, size_t{5} << 20};
  std::vector<float> numbers(table.rows * table.elements);
  for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i / table.elements);
  const auto cells = std::as_bytes(std::span(numbers));
  auto file = *h5::File::create(path);
  ASSERT_OK(write_number_blocks(file, "/values", table, cells));
  // As many rows as make a block whole must fit, not these two alone.
  const auto rows = static_cast<uint64_t>(*file.int_attribute("/values", "rows_per_block"));
  EXPECT_LE(rows * table.row_bytes(), kMaxNumberBlockBytes);
  ASSERT_OK(file.close());
  SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
  NumberBlocks blocks(source);
  for (uint64_t row = 0; row < table.rows; ++row) {
    const auto found = blocks.row("/values", table, row);
    ASSERT_OK(found);
    EXPECT_TRUE(
        std::ranges::equal(*found, cells.subspan(row * table.row_bytes(), table.row_bytes())));
  }
}

TEST(NumberBlocks, RefuseRowsThatWouldNotBeReadAgain) {
  const ScratchDirectory scratch;
  auto file = *h5::File::create(scratch / "s.h5");
  const NumberTable table{idf::ElementType::kFloat64, 1, 1, (kMaxNumberBlockBytes >> 3) + 1};
  EXPECT_FAILS(write_number_blocks(file, "/values", table, {}), StatusCode::kInvalidArgument,
               "at most");
}

TEST(NumberBlocks, OfManyTablesAreKeptAsFarAsTheyFit) {
  constexpr uint64_t kRows = 1000, kKept = 3 * kRows * sizeof(double);
  const ScratchDirectory scratch;
  const auto path = scratch / "s.h5";
  const NumberTable table{idf::ElementType::kFloat64, kRows, 1, 1};
  std::vector<double> numbers(kRows);
  auto file = *h5::File::create(path);
  for (int i = 0; i < 8; ++i) {
    numbers.assign(kRows, i);
    ASSERT_OK(write_number_blocks(file, "/" + std::to_string(i), table,
                                  std::as_bytes(std::span(numbers))));
  }
  ASSERT_OK(file.close());
  SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
  NumberBlocks blocks(source, kKept);
  for (int look = 0; look < 40; ++look) {
    const int i = look * 3 % 8;
    const auto row = blocks.row("/" + std::to_string(i), table, kRows - 1);
    ASSERT_OK(row);
    EXPECT_EQ(h5::as_vector<double>(*row), std::vector<double>{static_cast<double>(i)});
    EXPECT_LE(blocks.held_bytes(), kKept);
  }
  EXPECT_EQ(blocks.held_bytes(), kKept);
  NumberBlocks narrow(source, 1);
  ASSERT_OK(narrow.row("/0", table, 0));
  ASSERT_OK(narrow.row("/1", table, 0));
  EXPECT_EQ(narrow.held_bytes(), kRows * sizeof(double)) << "one is always kept";
}

TEST(NumberBlocks, StayBlocksInASegmentThatIsWrittenAnew) {
  const ScratchDirectory scratch;
  const auto store = scratch / "store";
  ASSERT_OK(create_store(store));
  StoreWriter::Options options;
  options.seal_rules = [](const MemoryId&) { return SealRules::all_columns(); };
  for (const int64_t first : {0, 50}) {
    const auto writer = *StoreWriter::open(store, options);
    for (int64_t i = first; i < first + 50; ++i)
      ASSERT_OK(writer->append({pack_snapshot(numbers(i))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  ASSERT_OK(compact(store, {}));
  ASSERT_OK(forget_snapshots(store, {{example_entity(), {example_time(99)}}}));
  const auto segments = read_manifest(store)->segments;
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_TRUE(
      (*SegmentReader::open(store / segments[0].file))->forms(example_entity())->has_columns());
  expect_numbers(store / segments[0].file, 99);
}

TEST(NumberBlocks, StayThoseThatTheyWereWhereASegmentIsWrittenAnew) {
  const ScratchDirectory scratch;
  const auto store = scratch / "store";
  ASSERT_OK(create_store(store));
  StoreWriter::Options options;
  options.seal_rules = [](const MemoryId&) {
    return *SealRules::create(
        {.rules = {{.path = "joints/**", .kind = MediumKind::kNumber, .codec = "none"},
                   {.path = "f*", .kind = MediumKind::kNumber, .codec = "columns"}}});
  };
  for (const int64_t first : {0, 50}) {
    const auto writer = *StoreWriter::open(store, options);
    for (int64_t i = first; i < first + 50; ++i)
      ASSERT_OK(writer->append({pack_snapshot(numbers(i))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const std::set<std::string, std::less<>> columns{"float", "force"};
  EXPECT_EQ((*StoreReader::open(store))->forms(example_entity(), 0)->columns, columns);
  ASSERT_OK(compact(store, {}));
  EXPECT_EQ((*StoreReader::open(store))->forms(example_entity(), 0)->columns, columns);
  ASSERT_OK(forget_snapshots(store, {{example_entity(), {example_time(99)}}}));
  EXPECT_EQ((*StoreReader::open(store))->forms(example_entity(), 0)->columns, columns);
}

class HostileBlocks : public ::testing::Test {
 protected:
  /// Asks for a row of a table whose blobs are `blobs`.
  Status read(const std::vector<std::string>& blobs, int64_t rows_per_block,
              const NumberTable& table, uint64_t row, const std::string& codec = "columns") {
    const auto path = scratch_ / ("s" + std::to_string(++files_) + ".h5");
    auto file = *h5::File::create(path);
    BlobColumn column;
    for (const std::string& blob : blobs) column.append(as_bytes(blob));
    EXPECT_OK(column.write(file, "/values"));
    EXPECT_OK(file.write_attribute("/values", "codec", codec));
    EXPECT_OK(file.write_attribute("/values", "rows_per_block", rows_per_block));
    EXPECT_OK(file.close());
    SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
    return NumberBlocks(source).row("/values", table, row).status();
  }

  ScratchDirectory scratch_;
  int files_ = 0;
};

TEST_F(HostileBlocks, AreRefused) {
  const NumberTable table{idf::ElementType::kFloat64, 100, 2, 1};
  EXPECT_FAILS(read({"a", "b"}, 64, table, 3, "gzip"), StatusCode::kDataLoss, "'gzip'");
  EXPECT_FAILS(read({"a", "b"}, 0, table, 3), StatusCode::kDataLoss, "0 rows per block");
  EXPECT_FAILS(read({"a", "b"}, -5, table, 3), StatusCode::kDataLoss, "rows per block");
  EXPECT_FAILS(read({"a", "b"}, INT64_MAX, table, 3), StatusCode::kDataLoss, "rows per block");
  EXPECT_FAILS(read({"a", "b"}, 64, table, 100), StatusCode::kDataLoss, "needs row 100");
  EXPECT_FAILS(read({"a", "b"}, 64, table, 3), StatusCode::kDataLoss, "");
  EXPECT_FAILS(read({"a", "b"}, 64, table, 70), StatusCode::kDataLoss, "");
  EXPECT_FAILS(read({}, 64, table, 3), StatusCode::kDataLoss, "");
  const NumberTable huge{idf::ElementType::kFloat64, uint64_t{1} << 40, 2, 1};
  EXPECT_FAILS(read({"a", "b"}, int64_t{1} << 32, huge, 3), StatusCode::kDataLoss, "at most");
}

}  // namespace
}  // namespace engram::ltm
