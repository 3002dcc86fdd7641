// SPDX-License-Identifier: Apache-2.0
// Segments written and read again: ltm/store/segment_writer.h and segment_reader.h.
#include <bit>
#include <set>

#include "ltm/h5/h5.h"
#include "ltm/store/segment_format.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/segment_files.h"

namespace engram::ltm {
namespace {

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

TEST(Segment, GivesBackWhatInstancesWereMadeOf) {
  Entities entities;
  for (int64_t i = 0; i < 10; ++i) {
    Snapshot snapshot{example_entity(), example_time(i), {{robot_value(i), example_metadata(i)}}};
    if (i % 3 == 1) {
      snapshot.instances[0].metadata.origin = example_entity("cam").at(example_time(i)).instance(0);
      snapshot.instances[0].metadata.recipe = "{\"version\":1,\"n\":" + std::to_string(i) + "}";
    }
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
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
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
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
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
  snapshots[1].instances[0].quality.error = {nan, 0.5};
  snapshots[2].instances[0].quality.error = {0.0, nan};
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
      EXPECT_EQ(a.quality, b.quality);
    }
  }
}

TEST(Segment, TellsWhatFaded) {
  const ScratchDirectory scratch;
  std::vector<LatentSnapshot> snapshots = example_latents(0, 5, 4);
  snapshots[1].instances[0].quality = {{40.0, 0.5}, {}, 32};
  snapshots[3].instances[0].quality = {{90.0, 0.5}, {{120.0, 0.7}}, LatentQuality::kGist};
  ASSERT_OK(write_latent_segment(scratch / "l.h5", example_entity(), snapshots));
  const auto reader = SegmentReader::open(scratch / "l.h5");
  const auto spans = (*reader)->index(example_entity());
  for (size_t i = 0; i < snapshots.size(); ++i) {
    const auto qualities = (*reader)->read_qualities(example_entity(), (*spans)[i]);
    ASSERT_OK(qualities);
    ASSERT_EQ(qualities->size(), 1u);
    EXPECT_EQ(qualities->front(), snapshots[i].instances[0].quality) << i;
    EXPECT_EQ((*reader)->read_latent(example_entity(), (*spans)[i])->instances[0].quality,
              qualities->front());
  }
}

TEST(Segment, RefusesImpossibleFading) {
  const ScratchDirectory scratch;
  std::vector<LatentSnapshot> snapshots = example_latents(0, 5, 4);
  snapshots[2].instances[0].quality.faded_to_db = -1;
  ASSERT_OK(write_latent_segment(scratch / "l.h5", example_entity(), snapshots));
  const auto reader = SegmentReader::open(scratch / "l.h5");
  const auto spans = (*reader)->index(example_entity());
  EXPECT_OK((*reader)->read_qualities(example_entity(), (*spans)[1]));
  EXPECT_EQ((*reader)->read_qualities(example_entity(), (*spans)[2]).status().code(),
            StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::ltm
