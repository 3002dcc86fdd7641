// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/packed_value.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

TEST(PackedValue, GivesBackTheValue) {
  const idf::Data value = idf::Dict{{"left/right", example_image(10, 12, 3, 1)},
                                    {"deep", idf::Dict{{"", example_image(8, 8, 1, 2)}}},
                                    {"list", idf::List{example_image(8, 8, 3, 3)}},
                                    {"x", 1.5}};
  const auto packed = pack(value, {});
  ASSERT_OK(packed);
  ASSERT_EQ(packed->media.size(), 2u);
  EXPECT_EQ(packed->media[0].path, "left\\/right");
  EXPECT_EQ(packed->media[0].codec, "png");
  EXPECT_TRUE(packed->rest.at("left\\/right")->is<idf::None>());
  EXPECT_EQ(*unpack(*packed), value);
}

TEST(PackedValue, GivesBackAValueThatIsAnImage) {
  const idf::Data value = example_image(9, 9, 3, 1);
  const auto packed = pack(value, {});
  ASSERT_OK(packed);
  EXPECT_EQ(packed->media[0].path, "");
  EXPECT_EQ(*unpack(*packed), value);
}

TEST(PackedValue, GivesBackRandomValues) {
  RandomValues random(18);
  for (int i = 0; i < 1000; ++i) {
    const idf::Data value = random.value(4);
    const auto packed = pack(value, {});
    ASSERT_OK(packed);
    EXPECT_EQ(*unpack(*packed), value);
  }
}

TEST(PackedValue, FallsBackToZstdWhereTheCodecDoesNotAcceptTheImage) {
  const idf::Data value = example_image(8, 40'000, 1, 1);
  const auto packed = pack(value, {.image_codec = "png"});
  ASSERT_OK(packed);
  EXPECT_EQ(packed->media[0].codec, "zstd");
  EXPECT_EQ(*unpack(*packed), value);
}

TEST(PackedValue, RefusesAnUnknownCodec) {
  EXPECT_FAILS(pack(idf::Data(1), {.image_codec = "gif"}), StatusCode::kInvalidArgument, "'gif'");
}

TEST(PackedValue, RefusesMediaThatDoNotFit) {
  const auto packed = pack(idf::Dict{{"image", example_image(9, 9, 3, 1)}}, {});
  PackedValue other = *packed;
  other.media[0].path = "elsewhere";
  EXPECT_FAILS(unpack(other), StatusCode::kDataLoss, "no place");
  other = *packed;
  other.rest = idf::Dict{{"image", 1}};
  EXPECT_FAILS(unpack(other), StatusCode::kDataLoss, "no place");
  other = *packed;
  other.media[0].codec = "gif";
  EXPECT_FAILS(unpack(other), StatusCode::kDataLoss, "unknown codec 'gif'");
  other = *packed;
  other.media[0].shape = {8, 9, 3};
  EXPECT_FAILS(unpack(other), StatusCode::kDataLoss, "member 'image'");
}

}  // namespace
}  // namespace engram::ltm
