// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_value_reader.h"

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_source.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/segment_files.h"

namespace engram::ltm {
namespace {

/// Reads an entity whose file has layout and times, and nothing of what the layout names.
Status read_without_tables(const std::filesystem::path& path, const idf::Data& value) {
  const auto layout =
      *idf::encode(idf::Layout::of(value).to_data(), idf::kMaxDepth + idf::kContainerDepth);
  const uint64_t size = layout.size(), rows = 1;
  auto file = *h5::File::create(path);
  EXPECT_OK(file.make_group("/e"));
  EXPECT_OK(
      file.write("/e/layout", h5::Type::kUInt8, {&size, 1}, layout, h5::Storage::kCompressed));
  const int64_t time = 1;
  EXPECT_OK(file.write("/e/timestamp", h5::Type::kInt64, {&rows, 1},
                       std::as_bytes(std::span(&time, 1)), h5::Storage::kCompressed));
  EXPECT_OK(file.close());
  SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
  return SegmentValueReader(source).columns("/e").status();
}

TEST(SegmentValueReader, CallsAMissingDatasetDataLoss) {
  const ScratchDirectory scratch;
  const auto array = idf::NdArray::take<float>({2, 3}, std::vector<float>(6, 1.0f));
  EXPECT_FAILS(read_without_tables(scratch / "array.h5", idf::Dict{{"force", array}}),
               StatusCode::kDataLoss, "'/e/arrays/force': is missing");
  EXPECT_FAILS(read_without_tables(scratch / "number.h5", idf::Dict{{"x", 1.0}}),
               StatusCode::kDataLoss, "'/e/columns/float64/values': is missing");
}

TEST(SegmentValueReader, KeepsBlocksOfLargeRemaindersSmall) {
  Entities entities;
  for (int64_t i = 0; i < 40; ++i) {
    const std::string text(480'000, static_cast<char>('a' + i % 20));
    entities[example_entity()].push_back(
        {example_entity(), example_time(i), {{idf::Dict{{"text", text}}, {}}}});
  }
  expect_round_trip(entities);
  const ScratchDirectory scratch;
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  const auto file = h5::File::open(scratch / "s.h5");
  const std::string group = segment_group(example_entity());
  EXPECT_LE(*file->int_attribute(group + "/remainder", "rows_per_block"), 20);
}

TEST(SegmentValueReader, GivesManySmallBlocksOfARemainderADictionaryWhereItPays) {
  const ScratchDirectory scratch;
  const std::string dictionary = segment_group(example_entity()) + "/remainder/dictionary";
  const auto has_dictionary = [&](int64_t count, const auto& text_of) {
    Entities entities;
    for (int64_t i = 0; i < count; ++i)
      entities[example_entity()].push_back(
          {example_entity(), example_time(i), {{idf::Dict{{"text", text_of(i)}}, {}}}});
    EXPECT_OK(write_entities(scratch / "s.h5", entities));
    const auto reader = *SegmentReader::open(scratch / "s.h5");
    const auto found = read_entity(*reader, example_entity());
    EXPECT_OK(found);
    for (size_t i = 0; i < found->size(); i += 97)
      EXPECT_EQ((*found)[i], entities[example_entity()][i]) << i;
    const bool is_there = *h5::File::open(scratch / "s.h5")->exists(dictionary);
    std::filesystem::remove(scratch / "s.h5");
    return is_there;
  };
  const auto alike = [](int64_t i) {
    return fmt::format("the gripper closed around cup {} of the kitchen", i * 7919 % 10'007);
  };
  RandomValues random(3);
  const auto noise = [&](int64_t) {
    std::string text;
    for (int i = 0; i < 12; ++i) text += static_cast<char>(random.below(255) + 1);
    return text;
  };
  EXPECT_TRUE(has_dictionary(16'000, alike));
  EXPECT_FALSE(has_dictionary(4'000, alike));
  EXPECT_FALSE(has_dictionary(9'000, noise));
}

TEST(SegmentValueReader, RefusesADictionaryThatIsNone) {
  const ScratchDirectory scratch;
  {
    auto file = *h5::File::create(scratch / "s.h5");
    BlobColumn blobs;
    blobs.append(as_bytes("a block"));
    ASSERT_OK(blobs.write(file, "/remainder"));
    ASSERT_OK(file.write_attribute("/remainder", "rows_per_block", int64_t{8}));
    const std::vector<std::byte> bytes(300, std::byte{7});
    const uint64_t count = bytes.size();
    ASSERT_OK(file.write("/remainder/dictionary", h5::Type::kUInt8, {&count, 1}, bytes,
                         h5::Storage::kCompressed));
    ASSERT_OK(file.close());
  }
  SegmentSource source(*h5::File::open(scratch / "s.h5"),
                       *File::open(scratch / "s.h5", File::Mode::kRead));
  EXPECT_FAILS(SegmentValueReader(source).remainder("/remainder", 3), StatusCode::kDataLoss,
               "dictionary");
}

}  // namespace
}  // namespace engram::ltm
