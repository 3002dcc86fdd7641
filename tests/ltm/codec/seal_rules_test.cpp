// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/seal_rules.h"

#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::ElementType;

const idf::Shape kPicture{24, 32, 3};

PackOptions with(const PackRule& rule) {
  return {.rules = {rule}};
}

TEST(SealRules, AreEmptyWithoutGroupsAndColumns) {
  EXPECT_TRUE(SealRules().empty());
  EXPECT_TRUE(SealRules::create({})->empty());
  EXPECT_TRUE(SealRules::create(with({.codec = "ffv1"}))->empty());
  EXPECT_TRUE(SealRules::create(with({.codec = "none"}))->empty());
  EXPECT_FALSE(SealRules::create(with({.codec = "ffv1:group=5"}))->empty());
  EXPECT_EQ(SealRules().group_codec("a", ElementType::kUInt8, kPicture), nullptr);
  EXPECT_FALSE(SealRules().are_columns("a"));
}

TEST(SealRules, TakeTheFirstThatFits) {
  const auto rules =
      SealRules::create({.rules = {{.path = "mask", .kind = MediumKind::kImage, .codec = "png"},
                                   {.path = "left", .codec = "ffv1:group=7"},
                                   {.kind = MediumKind::kImage, .codec = "h264:group=9"},
                                   {.path = "raw/**", .kind = MediumKind::kNumber, .codec = "none"},
                                   {.kind = MediumKind::kNumber, .codec = "columns"}}});
  ASSERT_OK(rules);
  const auto size_of = [&](std::string_view path, ElementType type, const idf::Shape& shape) {
    const GroupCodec* codec = rules->group_codec(path, type, shape);
    return codec == nullptr ? 0 : codec->group_size();
  };
  EXPECT_EQ(size_of("mask", ElementType::kUInt8, kPicture), 0u);
  EXPECT_EQ(size_of("left", ElementType::kUInt8, kPicture), 7u);
  EXPECT_EQ(size_of("right", ElementType::kUInt8, kPicture), 9u);
  EXPECT_EQ(size_of("right", ElementType::kUInt16, {24, 32, 1}), 0u);
  EXPECT_EQ(size_of("left", ElementType::kUInt16, {24, 32, 1}), 7u);
  EXPECT_EQ(size_of("left", ElementType::kFloat64, {24, 32, 1}), 0u);
  EXPECT_TRUE(rules->are_columns("joints/1"));
  EXPECT_FALSE(rules->are_columns("raw/1"));
}

TEST(SealRules, OfPathsAreForTheseAlone) {
  const SealRules rules = SealRules::columns({"joints/*", "x"});
  EXPECT_TRUE(rules.are_columns("x"));
  EXPECT_TRUE(rules.are_columns("joints/*"));
  EXPECT_FALSE(rules.are_columns("joints/1")) << "a path, no pattern";
  EXPECT_EQ(rules.group_codec("x", ElementType::kUInt8, kPicture), nullptr);
  EXPECT_TRUE(SealRules::columns({}).empty());
}

TEST(SealRules, RecordImagesForGroupsWithoutLoss) {
  const idf::NdArray image = smooth_image(24, 32, 3);
  const auto codec_of = [&](const PackRule& rule) {
    return pack(image, with(rule))->media.at(0).codec;
  };
  EXPECT_EQ(codec_of({.codec = "h264"}), "rowpred");
  EXPECT_EQ(codec_of({.codec = "h264", .journal = "png"}), "png");
  EXPECT_EQ(codec_of({.codec = "ffv1:group=3"}), "rowpred");
  EXPECT_EQ(codec_of({.codec = "ffv1"}), "ffv1");
  // What the journal's codec does not accept is recorded by one that does.
  const auto depth = idf::NdArray::take<float>({24, 32, 1}, std::vector<float>(24 * 32, 0.5f));
  EXPECT_EQ(pack(depth, with({.codec = "h264", .journal = "png"}))->media.at(0).codec, "rowpred");
}

TEST(SealRules, RefuseWhatContradictsItself) {
  const auto refused = [](const PackRule& rule, std::string_view part) {
    EXPECT_FAILS(with(rule).validate(), StatusCode::kInvalidArgument, std::string(part));
    EXPECT_FAILS(SealRules::create(with(rule)), StatusCode::kInvalidArgument, std::string(part));
  };
  refused({.kind = MediumKind::kNumber, .codec = "h264"}, "not for numbers");
  refused({.kind = MediumKind::kNumber, .codec = "zstd"}, "not for numbers");
  refused({.kind = MediumKind::kImage, .codec = "columns"}, "needs kind: number");
  refused({.codec = "columns"}, "needs kind: number");
  refused({.kind = MediumKind::kCloud, .codec = "h264"}, "is for images");
  refused({.codec = "h264", .journal = "jpeg"}, "has loss");
  refused({.codec = "h264", .journal = "gif"}, "unknown codec 'gif'");
  refused({.codec = "png", .journal = "rowpred"}, "that of the journal already");
  refused({.codec = "h264:crf=99"}, "crf is 99");
  refused({.codec = "h256"}, "'h256', needs one of: av1, ffv1, h264, h265, jpeg");
  refused({.codec = "h264:level=2"}, "no option 'level'");
}

}  // namespace
}  // namespace engram::ltm
