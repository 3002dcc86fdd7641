// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/packed_value.h"

#include <map>

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

TEST(PackedValue, PutsLargeArraysThroughTheShuffleAndLeavesSmallOnes) {
  const idf::Data value =
      idf::Dict{{"cloud", idf::NdArray::take<float>({6000, 3}, std::vector<float>(18'000, 1.5f))},
                {"large", idf::NdArray::take<double>({8192}, std::vector<double>(8192, 2.5))},
                {"small", idf::NdArray::take<double>({8191}, std::vector<double>(8191, 2.5))}};
  const auto packed = pack(value, {});
  ASSERT_OK(packed);
  ASSERT_EQ(packed->media.size(), 2u);
  EXPECT_EQ(packed->media[0].path, "cloud");
  EXPECT_EQ(packed->media[1].path, "large");
  for (const PackedMedium& medium : packed->media) EXPECT_EQ(medium.codec, "shuffle");
  EXPECT_EQ(*unpack(*packed), value);
}

TEST(PackedValue, FollowsTheFirstRuleThatFits) {
  const idf::NdArray cloud = idf::NdArray::take<float>({9, 3}, std::vector<float>(27, 1.5f));
  const idf::NdArray depth = idf::NdArray::take<float>({9, 9, 1}, std::vector<float>(81, 1.5f));
  const idf::Data value = idf::Dict{{"left", idf::Dict{{"rgb", example_image(9, 9, 3, 1)}}},
                                    {"right", idf::Dict{{"rgb", example_image(9, 9, 3, 2)}}},
                                    {"thumb", example_image(9, 9, 3, 3)},
                                    {"depth", depth},
                                    {"cloud", cloud}};
  PackOptions options{.rules = {{.path = "left/*", .codec = "rowpred"},
                                {.path = "*/rgb", .codec = "png:9"},
                                {.path = "thumb", .codec = "none"},
                                {.kind = MediumKind::kCloud, .codec = "zstd:19"},
                                {.kind = MediumKind::kDepth, .codec = "png"}}};
  const auto packed = pack(value, options);
  ASSERT_OK(packed);
  std::map<std::string, std::string> codecs;
  for (const PackedMedium& medium : packed->media) codecs[medium.path] = medium.codec;
  // PNG has no floats: what a rule's codec does not accept is shuffled.
  const std::map<std::string, std::string> expected{
      {"left/rgb", "rowpred"}, {"right/rgb", "png"}, {"depth", "shuffle"}, {"cloud", "zstd"}};
  EXPECT_EQ(codecs, expected);
  EXPECT_EQ(*unpack(*packed), value);
}

TEST(PackedValue, StoresImagesUnderTheNameOfTheCodecWithoutItsOptions) {
  const auto packed = pack(example_image(9, 9, 3, 1), {.image_codec = "png:level=9"});
  ASSERT_OK(packed);
  EXPECT_EQ(packed->media[0].codec, "png");
}

TEST(PackedValue, KnowsKindsByTypeAndShape) {
  using idf::ElementType;
  EXPECT_EQ(medium_kind(ElementType::kUInt8, {8, 8, 3}), MediumKind::kImage);
  EXPECT_EQ(medium_kind(ElementType::kUInt8, {7, 8, 3}), MediumKind::kArray);
  EXPECT_EQ(medium_kind(ElementType::kUInt16, {8, 8, 1}), MediumKind::kDepth);
  EXPECT_EQ(medium_kind(ElementType::kFloat32, {8, 8, 1}), MediumKind::kDepth);
  EXPECT_EQ(medium_kind(ElementType::kFloat32, {8, 4}), MediumKind::kCloud);
  EXPECT_EQ(medium_kind(ElementType::kFloat64, {8, 4}), MediumKind::kArray);
  EXPECT_EQ(medium_kind(ElementType::kFloat32, {8, 2}), MediumKind::kArray);
}

TEST(PackedValue, MatchesPaths) {
  for (const char* pattern : {"**", "a/b/c", "a/*/c", "**/c", "a/**", "*/*/*", "a/?/c", "**b**"})
    EXPECT_TRUE(matches_path(pattern, "a/b/c")) << pattern;
  for (const char* pattern : {"", "*", "a/b", "a/*", "*/c", "a?b/c", "a/b/c/*", "b/**", "**d"})
    EXPECT_FALSE(matches_path(pattern, "a/b/c")) << pattern;
  EXPECT_TRUE(matches_path("**", ""));
  EXPECT_TRUE(matches_path("", ""));
  EXPECT_FALSE(matches_path("?", ""));
}

TEST(PackedValue, RefusesRulesThatMeanNothing) {
  EXPECT_FAILS((PackOptions{.rules = {{.path = "a", .codec = "gif"}}}.validate()),
               StatusCode::kInvalidArgument, "'gif'");
  EXPECT_FAILS((PackOptions{.rules = {{.path = "", .codec = "png"}}}.validate()),
               StatusCode::kInvalidArgument, "path is empty");
  EXPECT_FAILS((PackOptions{.array_codec = "png:77"}.validate()), StatusCode::kInvalidArgument,
               "needs 0 to 9");
  EXPECT_OK(PackOptions{}.validate());
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
