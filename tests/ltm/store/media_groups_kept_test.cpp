// SPDX-License-Identifier: Apache-2.0
// Groups of images in segments that are written anew, or damaged.
#include <algorithm>
#include <set>

#include "ltm/core/file.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_writer.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/media_groups_fixture.h"

namespace engram::ltm {
namespace {

using MediaGroupsKept = MediaGroupsFixture;

TEST_F(MediaGroupsKept, AreCopiedWholeByCompaction) {
  seal_pictures(0, 20, "h264:group=10");
  seal_pictures(20, 30, "h264:group=10");
  const auto before = read();
  const auto media_before = media();
  ASSERT_OK(compact(store_, {}));
  ASSERT_EQ(read_manifest(store_)->segments.size(), 1u);
  expect_content(before);
  const auto media_after = media();
  ASSERT_EQ(media_after.size(), media_before.size());
  for (size_t i = 0; i < media_after.size(); ++i) {
    EXPECT_EQ(media_after[i].codec, "h264");
    EXPECT_TRUE(std::ranges::equal(media_after[i].bytes.bytes(), media_before[i].bytes.bytes()));
  }
  expect_clean(store_);
}

TEST_F(MediaGroupsKept, AreTakenApartWithoutLossWhereOneImageIsForgotten) {
  seal_pictures(0, 30, "h264:group=10");
  auto expected = read();
  const Buffer gone = media()[13].bytes;
  ASSERT_OK(forget_snapshots(store_, {{example_entity(), {example_time(13)}}}));
  expected.erase(expected.begin() + 13);
  expect_content(expected);
  const auto names = codecs();
  EXPECT_EQ(names[9], "h264 9/10");
  EXPECT_EQ(names[10], "rowpred");
  EXPECT_EQ(names[18], "rowpred");
  EXPECT_EQ(names[19], "h264 0/10");
  const Buffer whole = *read_file(segment_file());
  EXPECT_TRUE(std::ranges::search(whole.bytes(), gone.bytes().last(64)).empty());
  EXPECT_FALSE(std::ranges::search(whole.bytes(), media()[0].bytes.bytes().last(64)).empty());
  expect_clean(store_);
  EXPECT_EQ((*StoreReader::open(store_))->forms(example_entity(), 0)->media_codecs,
            (std::set<std::string>{"h264", "rowpred"}));
}

TEST_F(MediaGroupsKept, LoseOneImageToAnUpdate) {
  seal_pictures(0, 10, "ffv1:group=10");
  const Snapshot update = snapshot(4, picture(77));
  seal({update}, "ffv1:group=10");
  auto expected = read();
  EXPECT_EQ(expected[4], update);
  ASSERT_OK(compact(store_, {}));
  expect_content(expected);
  EXPECT_EQ(codecs()[3], "rowpred");
  EXPECT_EQ(codecs()[4], "ffv1 0/1");
  expect_clean(store_);
}

TEST_F(MediaGroupsKept, AreRecoveredButForTheDamagedOne) {
  seal_pictures(0, 30, "h264:group=10");
  const auto before = read();
  const Buffer group = media()[10].bytes;
  const Buffer whole = *read_file(segment_file());
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  const auto place = std::ranges::search(damaged, group.bytes());
  ASSERT_FALSE(place.empty());
  *(place.begin() + 20) ^= std::byte{1};
  overwrite_file(segment_file(), damaged);
  EXPECT_FALSE(check_store(store_)->is_clean());
  const auto copy = scratch_ / "copy";
  const auto report = recover_store(store_, copy);
  ASSERT_OK(report);
  EXPECT_EQ(report->entities.at(example_entity()).recorded, 20u);
  EXPECT_EQ(report->entities.at(example_entity()).recorded_lost, 10u);
  std::filesystem::remove_all(store_);
  std::filesystem::rename(copy, store_);
  auto expected = before;
  expected.erase(expected.begin() + 10, expected.begin() + 20);
  expect_content(expected);
  EXPECT_EQ(codecs()[0], "h264 0/10");
  EXPECT_EQ(codecs()[19], "h264 9/10");
  EXPECT_TRUE((*StoreReader::open(store_))->forms(example_entity(), 0)->has_columns());
  expect_clean(store_);
}

TEST_F(MediaGroupsKept, ThatDoNotDecodeAreLostAloneWhereTheirSegmentIsDamaged) {
  const Buffer nothing = Buffer::copy(as_bytes("no group of images"));
  RecordedEntity recorded;
  std::vector<Snapshot> expected;
  for (int64_t i = 0; i < 30; ++i) {
    Snapshot made = snapshot(i, picture(i));
    made.instances[0].data.get_if<idf::Dict>()->set("other", picture(i, 1));
    recorded.snapshots.push_back(packed(made, {}));
    if (i < 10 || i >= 20) expected.push_back(made);
    if (i < 10 || i >= 20) continue;
    PackedMedium& medium = recorded.snapshots.back().instances[0].value.media[0];
    ASSERT_EQ(medium.path, "image");
    medium.codec = "h264";
    medium.bytes = nothing;
    medium.group = {static_cast<uint32_t>(i - 10), 10};
  }
  auto info =
      *write_recorded_segment(store_ / "segments/000001.h5", {{example_entity(), recorded}});
  info.file = "segments/000001.h5";
  ASSERT_OK(edit_manifest(store_, [&info](Manifest& manifest) {
    manifest.segments.push_back(info);
    manifest.next_segment = 2;
    return Status();
  }));
  // The group is cut where the other image of a row is damaged.
  const Buffer other = recorded.snapshots[13].instances[0].value.media[1].bytes;
  const Buffer whole = *read_file(segment_file());
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  const auto place = std::ranges::search(damaged, other.bytes());
  ASSERT_FALSE(place.empty());
  place.front() ^= std::byte{1};
  overwrite_file(segment_file(), damaged);
  const auto copy = scratch_ / "copy";
  const auto report = recover_store(store_, copy);
  ASSERT_OK(report);
  EXPECT_EQ(report->entities.at(example_entity()).recorded, 20u);
  EXPECT_EQ(report->entities.at(example_entity()).recorded_lost, 10u);
  EXPECT_EQ(*read_all(**StoreReader::open(copy), example_entity()), expected);
}

TEST_F(MediaGroupsKept, WithFlippedBitsAreFoundAndNeverWrong) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 120; ++i)
    snapshots.push_back(snapshot(i, i % 5 == 2 ? idf::Data() : idf::Data(picture(i))));
  seal(snapshots, "h264:group=6");
  const auto expected = read();
  const Buffer whole = *read_file(segment_file());
  RandomValues random(5);
  for (int flip = 0; flip < 150; ++flip) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    const uint64_t bit = random.below(damaged.size() * 8);
    damaged[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    overwrite_file(segment_file(), damaged);
    const auto report = check_store(store_);
    EXPECT_TRUE(!report.ok() || !report->is_clean()) << bit;
    const auto reader = StoreReader::open(store_);
    const auto entries = reader.ok() ? (*reader)->index(example_entity()) : reader.status();
    if (!entries.ok()) continue;
    ASSERT_EQ((*entries)->size(), expected.size()) << bit;
    for (size_t i = 0; i < expected.size(); ++i) {
      const auto found = (*reader)->read_recorded(example_entity(), (**entries)[i]);
      if (found.ok()) {
        EXPECT_EQ(*found, expected[i]) << bit;
      }
    }
  }
}

}  // namespace
}  // namespace engram::ltm
