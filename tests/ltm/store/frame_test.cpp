// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/frame.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

Snapshot stereo_snapshot() {
  Snapshot snapshot{*MemoryId::from_names({"a/b", "c\\d", "ü", "."}), example_time(3), {}};
  for (int64_t side = 0; side < 2; ++side)
    snapshot.instances.push_back(
        {idf::Dict{{"image", example_image(16, 12, 3, side)}, {"label", "left"}},
         example_metadata(side)});
  return snapshot;
}

TEST(Frame, GivesBackTheSnapshot) {
  const Snapshot snapshot = stereo_snapshot();
  PackedSnapshot packed = pack_snapshot(snapshot);
  packed.dropped = 5;
  packed.dropped_bytes = 1234;
  const auto decoded = decode_frame(Buffer::take(*encode_frame(packed)));
  ASSERT_OK(decoded);
  EXPECT_EQ(decoded->raw_bytes, snapshot.raw_bytes());
  EXPECT_EQ(decoded->dropped, 5u);
  EXPECT_EQ(decoded->dropped_bytes, 1234u);
  const auto unpacked = unpack(*decoded);
  ASSERT_OK(unpacked);
  EXPECT_EQ(*unpacked, snapshot);
}

TEST(Frame, GivesBackWhatInstancesWereMadeOf) {
  Snapshot snapshot = stereo_snapshot();
  const auto head_of = [](const Snapshot& of) {
    return decode_frame_head(Buffer::take(*encode_frame(pack_snapshot(of))));
  };
  EXPECT_FALSE(head_of(snapshot)->is_augmented);
  snapshot.instances[1].metadata.origin = example_entity().at(example_time(2)).instance(0);
  snapshot.instances[1].metadata.recipe = R"({"version":1,"changes":[]})";
  EXPECT_TRUE(head_of(snapshot)->is_augmented);
  const auto decoded = decode_frame(Buffer::take(*encode_frame(pack_snapshot(snapshot))));
  ASSERT_OK(decoded);
  EXPECT_TRUE(decoded->is_augmented());
  EXPECT_EQ(*unpack(*decoded), snapshot);
}

TEST(Frame, GivesBackRandomValues) {
  RandomValues random(11);
  for (int i = 0; i < 300; ++i) {
    const Snapshot snapshot{example_entity(), example_time(i), {{random.value(4), {}}}};
    const auto decoded = decode_frame(Buffer::take(*encode_frame(pack_snapshot(snapshot))));
    ASSERT_OK(decoded);
    const auto unpacked = unpack(*decoded);
    ASSERT_OK(unpacked);
    EXPECT_EQ(*unpacked, snapshot);
  }
}

TEST(Frame, HeadSaysWhatAnIndexNeeds) {
  PackedSnapshot packed = pack_snapshot(stereo_snapshot());
  packed.dropped = 2;
  packed.dropped_bytes = 30;
  const auto head = decode_frame_head(Buffer::take(*encode_frame(packed)));
  ASSERT_OK(head);
  EXPECT_EQ(head->entity, packed.entity);
  EXPECT_EQ(head->time, packed.time);
  EXPECT_EQ(head->raw_bytes, packed.raw_bytes);
  EXPECT_EQ(head->dropped, 2u);
  EXPECT_EQ(head->dropped_bytes, 30u);
  EXPECT_EQ(head->instances, 2u);
}

TEST(Frame, RefusesAValueThatNestsTooDeep) {
  const Snapshot snapshot{example_entity(), example_time(0), {{nested_lists(65), {}}}};
  EXPECT_FAILS(encode_frame(pack_snapshot(snapshot)), StatusCode::kInvalidArgument, "64 levels");
}

TEST(Frame, MetadataGivesBackItself) {
  const InstanceMetadata metadata = example_metadata(4);
  EXPECT_EQ(*metadata_from_data(metadata_to_data(metadata)), metadata);
  EXPECT_FAILS(metadata_from_data(idf::Data(5)), StatusCode::kDataLoss, "created");
}

TEST(Frame, SurvivesEveryTruncation) {
  const auto payload = *encode_frame(pack_snapshot(stereo_snapshot()));
  for (size_t size = 0; size < payload.size(); ++size) {
    const auto decoded = decode_frame(Buffer::copy({payload.data(), size}));
    EXPECT_FAILS(decoded, StatusCode::kDataLoss, "");
  }
}

TEST(Frame, SurvivesRandomDamage) {
  const auto payload = *encode_frame(pack_snapshot(stereo_snapshot()));
  RandomValues random(12);
  for (int i = 0; i < 5000; ++i) {
    auto damaged = payload;
    for (size_t flips = 1 + random.below(3); flips > 0; --flips)
      damaged[random.below(damaged.size())] ^= static_cast<std::byte>(1 + random.below(255));
    const auto decoded = decode_frame(Buffer::take(std::move(damaged)));
    if (decoded.ok()) (void)unpack(*decoded).ok();
  }
}

}  // namespace
}  // namespace engram::ltm
