// SPDX-License-Identifier: Apache-2.0
// Segments written and read again: ltm/store/segment_writer.h and segment_reader.h.
#include <bit>
#include <set>

#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_value_reader.h"
#include "ltm/store/segment_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

using Entities = std::map<MemoryId, std::vector<Snapshot>>;

Result<SegmentInfo> write(const std::filesystem::path& file, const Entities& entities) {
  std::map<MemoryId, RecordedEntity> packed;
  for (const auto& [id, snapshots] : entities)
    for (const Snapshot& snapshot : snapshots)
      packed[id].snapshots.push_back(pack_snapshot(snapshot));
  return write_recorded_segment(file, packed);
}

Result<std::vector<Snapshot>> read(SegmentReader& reader, const MemoryId& entity) {
  std::vector<Snapshot> snapshots;
  ENGRAM_ASSIGN_OR_RETURN(const auto spans, reader.index(entity));
  for (const RowSpan& span : spans) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, reader.read_recorded(entity, span));
    ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, unpack(packed));
    snapshots.push_back(std::move(snapshot));
  }
  return snapshots;
}

/// A camera frame with 52 numbers of the robot and some text.
idf::Dict robot_value(int64_t index) {
  idf::Dict joints;
  for (int i = 0; i < 26; ++i) {
    joints.set("state." + std::to_string(i), 0.5 * static_cast<double>(index + i));
    joints.set("action." + std::to_string(i), 0.5f * static_cast<float>(index - i));
  }
  return {{"image", example_image(24, 32, 3, index)},
          {"joints", joints},
          {"flag", index % 2 == 0},
          {"task", "pick up the bottle"},
          {"path", idf::List{index, "x"}},
          {"force", idf::NdArray::take<float>({2, 3}, std::vector<float>(6, float(index)))}};
}

void expect_round_trip(const Entities& entities) {
  const ScratchDirectory scratch;
  const auto info = write(scratch / "s.h5", entities);
  ASSERT_OK(info);
  EXPECT_EQ(info->bytes, std::filesystem::file_size(scratch / "s.h5"));
  uint64_t sum = 0;
  for (const SegmentEntity& part : info->entities) sum += part.stored_bytes;
  EXPECT_EQ(sum, info->entities.empty() ? 0 : info->bytes);
  const auto reader = SegmentReader::open(scratch / "s.h5");
  ASSERT_OK(reader);
  for (const auto& [id, snapshots] : entities) {
    const auto found = read(**reader, id);
    ASSERT_OK(found);
    ASSERT_EQ(found->size(), snapshots.size());
    for (size_t i = 0; i < snapshots.size(); ++i) EXPECT_EQ((*found)[i], snapshots[i]) << i;
  }
}

TEST(Segment, GivesBackImagesNumbersAndStrings) {
  Entities entities;
  for (const char* name : {"cam", "arm"})
    for (int64_t i = 0; i < 30; ++i)
      entities[example_entity(name)].push_back(
          {example_entity(name), example_time(i), {{robot_value(i), example_metadata(i)}}});
  expect_round_trip(entities);
}

TEST(Segment, GivesBackStereoInstances) {
  Entities entities;
  for (int64_t i = 0; i < 10; ++i) {
    Snapshot snapshot{example_entity(), example_time(i), {}};
    for (int64_t side = 0; side < 1 + i % 3; ++side)
      snapshot.instances.push_back({robot_value(i * 2 + side), example_metadata(side)});
    entities[example_entity()].push_back(snapshot);
  }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackRowsOfDifferingLayout) {
  RandomValues random(21);
  Entities entities;
  for (int64_t i = 0; i < 400; ++i) {
    const idf::Data value =
        i % 3 == 0 ? idf::Data(robot_value(i)) : idf::Data(random.value(static_cast<int>(i % 5)));
    entities[example_entity()].push_back(
        {example_entity(), example_time(i), {{value, example_metadata(i)}}});
  }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackImagesOfDifferingSizeAndPlace) {
  Entities entities;
  for (int64_t i = 0; i < 12; ++i) {
    const idf::NdArray image = example_image(8 + i % 2, 8, i % 4 == 0 ? 1 : 3, i);
    idf::Data value = image;
    if (i % 3 == 1) value = idf::Dict{{"a", image}};
    // Names that collide with those of the datasets of a medium at "a".
    if (i % 3 == 2) value = idf::Dict{{"a", idf::Dict{{"bytes", image}, {"offset", image}}}};
    entities[example_entity()].push_back({example_entity(), example_time(i), {{value, {}}}});
  }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackOddNames) {
  Entities entities;
  for (const char* name :
       {"a/b", "%", ".", "..", "a%2Fb", "机器人", "with space", "#1", "\\", "\n"}) {
    const MemoryId id = *MemoryId::from_names({name, "core", name, name});
    const idf::Dict value{{name, 1.5},
                          {"", idf::Dict{{name, example_image(8, 8, 3, 1)}}},
                          {"list/of", idf::NdArray::take<int64_t>({2}, {1, 2})}};
    entities[id].push_back({id, example_time(1), {{value, example_metadata(1)}}});
  }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackAThousandRows) {
  Entities entities;
  for (int64_t i = 0; i < 1000; ++i)
    entities[example_entity()].push_back(example_snapshot(example_entity(), i));
  expect_round_trip(entities);
}

TEST(Segment, GivesBackEmptyAndDeepValues) {
  Entities entities;
  int64_t i = 0;
  for (const idf::Data& value :
       {idf::Data(), idf::Data(idf::Dict{}), idf::Data(idf::List{}), idf::Data(5),
        idf::Data("text"),
        idf::Data(idf::Dict{{"empty", idf::NdArray()},
                            {"hollow", idf::NdArray::take<double>({3, 0, 2}, {})}})}) {
    const MemoryId id = example_entity("value " + std::to_string(i));
    for (int64_t row = 0; row < 3; ++row)
      entities[id].push_back({id, example_time(row), {{value, {}}}});
    ++i;
  }
  for (const int depth : {62, 63, 64})
    for (const idf::Data& value : {nested_lists(depth), nested_dicts(depth)}) {
      const MemoryId id = example_entity("deep " + std::to_string(i++));
      entities[id].push_back({id, example_time(0), {{value, {}}}});
    }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackEmptyArraysOfHugeAxes) {
  Entities entities;
  constexpr int64_t kHuge = int64_t{1} << 40;
  for (int64_t i = 0; i < 4; ++i) {
    const auto array = idf::NdArray::take<float>({kHuge, kHuge, 0}, {});
    entities[example_entity()].push_back(
        {example_entity(), example_time(i), {{idf::Dict{{"a", array}, {"n", 1.0}}, {}}}});
  }
  expect_round_trip(entities);
}

TEST(Segment, GivesBackKeysWithZeroBytes) {
  const std::string key("a\0b", 3);
  Entities entities;
  entities[example_entity()].push_back({example_entity(),
                                        example_time(0),
                                        {{idf::Dict{{key, 1.0}, {std::string(1, '\0'), 2}}, {}}}});
  expect_round_trip(entities);
}

TEST(Segment, KeepsBlocksOfLargeRemaindersSmall) {
  Entities entities;
  for (int64_t i = 0; i < 40; ++i) {
    const std::string text(480'000, static_cast<char>('a' + i % 20));
    entities[example_entity()].push_back(
        {example_entity(), example_time(i), {{idf::Dict{{"text", text}}, {}}}});
  }
  expect_round_trip(entities);
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "s.h5", entities));
  const auto file = h5::File::open(scratch / "s.h5");
  const std::string group = segment_group(example_entity());
  EXPECT_LE(*file->int_attribute(group + "/remainder", "rows_per_block"), 20);
}

TEST(Segment, GivesManySmallBlocksOfARemainderADictionaryWhereItPays) {
  const ScratchDirectory scratch;
  const std::string dictionary = segment_group(example_entity()) + "/remainder/dictionary";
  const auto has_dictionary = [&](int64_t count, const auto& text_of) {
    Entities entities;
    for (int64_t i = 0; i < count; ++i)
      entities[example_entity()].push_back(
          {example_entity(), example_time(i), {{idf::Dict{{"text", text_of(i)}}, {}}}});
    EXPECT_OK(write(scratch / "s.h5", entities));
    const auto reader = *SegmentReader::open(scratch / "s.h5");
    const auto found = read(*reader, example_entity());
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

TEST(Segment, RefusesADictionaryThatIsNone) {
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

TEST(Segment, KeepsMediaOfVaryingShapeInOneGroup) {
  // Point clouds of varying length: each row has a layout of its own.
  Entities entities;
  for (int64_t i = 0; i < 40; ++i) {
    const int64_t points = i % 7 == 3 ? 0 : 8'000 + i;
    std::vector<float> values(static_cast<size_t>(points * 3), static_cast<float>(i));
    idf::Dict value{{"points", idf::NdArray::take({points, 3}, std::move(values))}};
    entities[example_entity()].push_back({example_entity(), example_time(i), {{value, {}}}});
  }
  expect_round_trip(entities);
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "s.h5", entities));
  const auto file = h5::File::open(scratch / "s.h5");
  const std::string group = segment_group(example_entity());
  EXPECT_FALSE(*file->exists(group + "/arrays/points"));
  const auto names = file->read_strings(group + "/media_groups");
  ASSERT_OK(names);
  EXPECT_EQ(*names, std::vector<std::string>{group + "/media/points"});
}

TEST(Segment, WithoutRowsIsReadable) {
  std::map<MemoryId, RecordedEntity> entities;
  entities[example_entity()] = {{}, 7, 700};
  const ScratchDirectory scratch;
  const auto info = write_recorded_segment(scratch / "s.h5", entities);
  ASSERT_OK(info);
  EXPECT_EQ(info->entities[0].dropped, 7u);
  EXPECT_EQ(info->entities[0].dropped_bytes, 700u);
  const auto reader = SegmentReader::open(scratch / "s.h5");
  ASSERT_OK(reader);
  EXPECT_TRUE((*reader)->index(example_entity())->empty());
  EXPECT_FAILS((*reader)->index(example_entity("other")), StatusCode::kNotFound, "other");
}

TEST(Segment, TellsItsContentsWithoutAManifest) {
  Entities entities;
  for (const char* name : {"a/b", "%", "#1", ".", "with space"}) {
    const MemoryId id = *MemoryId::from_names({name, "core", name, name});
    for (int64_t i = 0; i < 3; ++i) entities[id].push_back(example_snapshot(id, i));
  }
  const ScratchDirectory scratch;
  ASSERT_OK(write(scratch / "s.h5", entities));
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  const auto contents = reader->contents();
  ASSERT_OK(contents);
  EXPECT_EQ(contents->kind, SegmentKind::kRecorded);
  EXPECT_TRUE(contents->damaged.empty());
  EXPECT_EQ(std::set<MemoryId>(contents->entities.begin(), contents->entities.end()).size(), 5u);
  for (const MemoryId& id : contents->entities) {
    EXPECT_TRUE(entities.contains(id)) << id.to_string();
    EXPECT_EQ(*reader->row_count(id), 3u);
    EXPECT_EQ(*reader->time_at(id, 2), example_time(2));
    EXPECT_FAILS(reader->time_at(id, 3), StatusCode::kDataLoss, "needs row 3");
    EXPECT_GT(*reader->stored_bytes(id), 0u);
    EXPECT_FALSE(reader->model_version(id).ok());
  }
}

TEST(Segment, SumsWhatWasDropped) {
  RecordedEntity entity;
  for (int64_t i = 0; i < 4; ++i) {
    entity.snapshots.push_back(packed_example(i));
    entity.snapshots.back().dropped = static_cast<uint64_t>(i);
    entity.snapshots.back().dropped_bytes = static_cast<uint64_t>(10 * i);
  }
  entity.trailing_dropped = 100;
  entity.trailing_dropped_bytes = 1000;
  const ScratchDirectory scratch;
  const auto info = write_recorded_segment(scratch / "s.h5", {{example_entity(), entity}});
  ASSERT_OK(info);
  const SegmentEntity& summary = info->entities[0];
  EXPECT_EQ(summary.snapshots, 4u);
  EXPECT_EQ(summary.rows, 4u);
  EXPECT_EQ(summary.dropped, 106u);
  EXPECT_EQ(summary.dropped_bytes, 1060u);
  EXPECT_EQ(summary.first, example_time(0));
  EXPECT_EQ(summary.last, example_time(3));
  const auto reader = SegmentReader::open(scratch / "s.h5");
  const auto spans = (*reader)->index(example_entity());
  EXPECT_EQ((*reader)->read_recorded(example_entity(), (*spans)[3])->dropped, 3u);
}

TEST(Segment, GivesBackLatents) {
  const ScratchDirectory scratch;
  std::vector<LatentSnapshot> snapshots = example_latents(0, 300, 4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  snapshots[1].instances[0].error = {nan, 0.5};
  snapshots[2].instances[0].error = {0.0, nan};
  snapshots[3].instances[0].latent.code = Buffer();
  snapshots[4].instances.push_back(snapshots[5].instances[0]);
  const auto info = write_latent_segment(scratch / "l.h5", example_entity(), snapshots);
  ASSERT_OK(info);
  const LatentSums& sums = info->entities[0].latent;
  EXPECT_EQ(sums.model_version, 4);
  EXPECT_EQ(sums.image_rows, 300u);
  EXPECT_EQ(sums.number_rows, 300u);
  EXPECT_NEAR(sums.image_mse, 299 * 4.0, 1e-9);
  EXPECT_NEAR(sums.psnr_db, 60 + 299 * 10 * std::log10(255.0 * 255 / 4), 1e-6);
  const auto reader = SegmentReader::open(scratch / "l.h5");
  const auto spans = (*reader)->index(example_entity());
  ASSERT_EQ(spans->size(), snapshots.size());
  for (size_t i = 0; i < snapshots.size(); ++i) {
    const auto found = (*reader)->read_latent(example_entity(), (*spans)[i]);
    ASSERT_OK(found);
    EXPECT_EQ(found->model_version, 4);
    ASSERT_EQ(found->instances.size(), snapshots[i].instances.size());
    for (size_t k = 0; k < found->instances.size(); ++k) {
      const LatentInstance &a = found->instances[k], &b = snapshots[i].instances[k];
      EXPECT_TRUE(std::ranges::equal(a.latent.code.bytes(), b.latent.code.bytes()));
      EXPECT_EQ(a.latent.remainder, b.latent.remainder);
      EXPECT_EQ(a.metadata, b.metadata);
      EXPECT_EQ(std::isnan(a.error.image_mse), std::isnan(b.error.image_mse));
    }
  }
}

TEST(Segment, RefusesANewerFormat) {
  const ScratchDirectory scratch;
  {
    auto file = h5::File::create(scratch / "s.h5");
    ASSERT_OK(file->write_attribute("/", "format_version", int64_t{2}));
    ASSERT_OK(file->close());
  }
  EXPECT_FAILS(SegmentReader::open(scratch / "s.h5"), StatusCode::kFailedPrecondition, "up to 1");
}

TEST(Segment, IsNoOtherHdf5File) {
  const ScratchDirectory scratch;
  ASSERT_OK(h5::File::create(scratch / "s.h5")->close());
  EXPECT_FAILS(SegmentReader::open(scratch / "s.h5"), StatusCode::kDataLoss, "no segment");
}

/// A small segment with something of everything.
Entities small_entities() {
  Entities entities;
  for (int64_t i = 0; i < 40; ++i) {
    idf::Dict value{{"image", example_image(9, 9, 1, i)},
                    {"x", 0.5 * static_cast<double>(i)},
                    {"n", static_cast<int32_t>(i)},
                    {"v", idf::NdArray::take<float>({4}, std::vector<float>(4, float(i)))},
                    {"label", "l" + std::to_string(i)}};
    Snapshot snapshot{example_entity(), example_time(i), {{value, example_metadata(i)}}};
    snapshot.instances[0].metadata.provider = i % 2 == 0 ? "left driver" : "right driver";
    entities[example_entity()].push_back(snapshot);
  }
  return entities;
}

/// Reads everything of a segment: what can be read must be what was written.
void expect_original_or_error(const std::filesystem::path& file,
                              const std::vector<Snapshot>& expected, const std::string& damage) {
  const auto reader = SegmentReader::open(file);
  if (!reader.ok()) return;
  const auto spans = (*reader)->index(example_entity());
  if (!spans.ok()) return;
  ASSERT_EQ(spans->size(), expected.size()) << damage;
  for (size_t i = 0; i < spans->size(); ++i) {
    EXPECT_EQ((*spans)[i].time, expected[i].time) << damage;
    const auto packed = (*reader)->read_recorded(example_entity(), (*spans)[i]);
    if (!packed.ok()) continue;
    EXPECT_EQ(packed->raw_bytes, expected[i].raw_bytes()) << damage;
    EXPECT_EQ(packed->dropped, 0u) << damage;
    const auto snapshot = unpack(*packed);
    if (!snapshot.ok()) continue;
    EXPECT_EQ(*snapshot, expected[i]) << damage;
  }
}

TEST(Segment, NeverGivesWrongDataWhereAByteIsDamaged) {
  const ScratchDirectory scratch;
  const Entities entities = small_entities();
  ASSERT_OK(write(scratch / "s.h5", entities));
  const Buffer whole = *read_file(scratch / "s.h5");
  RandomValues random(31);
  for (size_t at = random.below(23); at < whole.size(); at += 23) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[at] ^= static_cast<std::byte>(1u << random.below(8));
    overwrite_file(scratch / "d.h5", damaged);
    expect_original_or_error(scratch / "d.h5", entities.at(example_entity()),
                             "byte " + std::to_string(at));
    if (HasFatalFailure()) return;
  }
}

TEST(Segment, NeverGivesWrongDataWhereItIsCutShort) {
  const ScratchDirectory scratch;
  const Entities entities = small_entities();
  ASSERT_OK(write(scratch / "s.h5", entities));
  const Buffer whole = *read_file(scratch / "s.h5");
  for (size_t size = 0; size < whole.size(); size += 997) {
    overwrite_file(scratch / "d.h5", whole.bytes().subspan(0, size));
    expect_original_or_error(scratch / "d.h5", entities.at(example_entity()),
                             "cut at " + std::to_string(size));
  }
}

}  // namespace
}  // namespace engram::ltm
