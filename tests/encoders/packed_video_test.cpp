// SPDX-License-Identifier: Apache-2.0
// Videos in a shorter code, and what they begin from.
#include "encoders/packed_video.h"

#include <gtest/gtest.h>

#include <random>

#include "encoders/latent_chain.h"
#include "ltm/codec/group_codec.h"

namespace engram::encoders {
namespace {

constexpr std::string_view kSettings = "effort=3,depth=10,spread=2";

/// Shades with a texture, in front of which a bright square has moved so far.
idf::NdArray scene_with_square(int64_t at, const idf::Shape& shape) {
  std::vector<uint8_t> pixels;
  for (int64_t y = 0; y < shape[0]; ++y)
    for (int64_t x = 0; x < shape[1]; ++x)
      for (int64_t c = 0; c < shape[2]; ++c) {
        const bool is_square = x >= at && x < at + 10 && y > 20 && y < 32;
        const int64_t texture = (x * x + 3 * y * x + 7 * y) % 61;
        pixels.push_back(static_cast<uint8_t>(is_square ? 230 : 60 + y + texture + 10 * c));
      }
  return idf::NdArray::take<uint8_t>(shape, std::move(pixels));
}

std::vector<idf::NdArray> scene_from(int64_t first, size_t count, const idf::Shape& shape) {
  std::vector<idf::NdArray> images;
  for (size_t i = 0; i < count; ++i)
    images.push_back(scene_with_square(first + 2 * static_cast<int64_t>(i), shape));
  return images;
}

FrameShape frame_of(const idf::Shape& shape) {
  return {idf::ElementType::kUInt8, shape};
}

class PackedVideo : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
  }
};

TEST_F(PackedVideo, DecodesAsItsGroupDoesAndIsShorter) {
  for (const idf::Shape& shape : {idf::Shape{64, 64, 3}, idf::Shape{48, 80, 1}})
    for (const char* text : {"av1:crf=30,effort=3,depth=10,spread=2", "av1:crf=30,effort=3"}) {
      const auto codec = *ltm::make_group_codec(text);
      const auto images = scene_from(0, 12, shape);
      const auto group = *codec->encode(images);
      const StoredVideo stored = to_stored_video("av1", group);
      EXPECT_EQ(stored.form, ImageForm::kPackedAv1);
      EXPECT_LT(stored.bytes.size() + 8 * images.size(), group.size()) << text;
      for (const size_t wanted : {size_t{0}, size_t{1}, size_t{5}, images.size()}) {
        const auto unpacked =
            decode_stored_video(stored.form, stored.bytes, frame_of(shape), 12, wanted, {});
        ASSERT_TRUE(unpacked.ok()) << unpacked.status().to_string();
        const auto decoded =
            *codec->decode_first(group, idf::ElementType::kUInt8, shape, 12, wanted);
        EXPECT_EQ(*unpacked, decoded) << text << ", " << wanted;
      }
    }
}

TEST_F(PackedVideo, KeepsOtherCodecsAsTheyAre) {
  const auto images = scene_from(0, 2, {64, 64, 3});
  const auto group = *(*ltm::make_group_codec("ffv1"))->encode(images);
  const StoredVideo stored = to_stored_video("ffv1", group);
  EXPECT_EQ(stored.form, ImageForm::kFfv1);
  EXPECT_EQ(stored.bytes, group);
  EXPECT_EQ(*decode_stored_video(stored.form, stored.bytes, frame_of({64, 64, 3}), 2, 2, {}),
            images);
  for (const ImageForm form : {ImageForm::kLatents, ImageForm::kGist})
    EXPECT_EQ(decode_stored_video(form, group, frame_of({64, 64, 3}), 2, 2, {}).status().code(),
              StatusCode::kDataLoss);
}

/// A reference of the scene without the square.
Result<OpenReference> reference_of_scene(const idf::Shape& shape) {
  return make_reference(scene_with_square(-100, shape), 30, kSettings);
}

TEST_F(PackedVideo, BeginsFromAReference) {
  const idf::Shape shape{64, 64, 3};
  const auto reference = reference_of_scene(shape);
  ASSERT_TRUE(reference.ok()) << reference.status().to_string();
  const auto images = scene_from(4, 10, shape);
  const auto packed = encode_from(*reference, images, 35, kSettings);
  ASSERT_TRUE(packed.ok()) << packed.status().to_string();
  ASSERT_TRUE(packed->has_value());
  EXPECT_EQ(*reference_of_video(**packed), reference->reference.hash());

  const auto alone = to_stored_video(
      "av1", *(*ltm::make_group_codec(fmt::format("av1:crf=35,{}", kSettings)))->encode(images));
  EXPECT_LT((*packed)->size(), alone.bytes.size());
  EXPECT_FALSE(reference_of_video(alone.bytes)->has_value());

  const std::vector references{reference->reference};
  const auto all = unpack_video(**packed, frame_of(shape), 10, 10, references);
  ASSERT_TRUE(all.ok()) << all.status().to_string();
  ASSERT_EQ(all->size(), images.size());
  for (size_t i = 0; i < images.size(); ++i)
    EXPECT_LT(reference_distance(images[i], (*all)[i]), 30) << i;
  const auto some = unpack_video(**packed, frame_of(shape), 10, 3, references);
  ASSERT_TRUE(some.ok());
  EXPECT_EQ(*some, std::vector(all->begin(), all->begin() + 3));
}

TEST_F(PackedVideo, MakesTheKeyFrameOfAReferenceAgain) {
  const idf::Shape shape{64, 64, 3};
  const auto first = reference_of_scene(shape);
  ASSERT_TRUE(first.ok());
  // As a later night does, which has what the model keeps.
  const auto kept = references_from(to_bytes(std::vector{first->reference}));
  ASSERT_TRUE(kept.ok()) << kept.status().to_string();
  ASSERT_EQ(*kept, std::vector{first->reference});
  const auto again = open_reference(kept->front(), frame_of(shape));
  ASSERT_TRUE(again.ok()) << again.status().to_string();
  EXPECT_EQ(again->picture, first->picture);
  for (const int crf : {31, 36, 45})
    EXPECT_TRUE(encode_from(*again, scene_from(9, 6, shape), crf, kSettings)->has_value()) << crf;
  // Another effort makes another key frame, and says so instead of coding from a wrong one.
  EXPECT_FALSE(
      encode_from(*again, scene_from(9, 6, shape), 36, "effort=5,depth=10,spread=2")->has_value());
}

TEST_F(PackedVideo, NeedsItsReference) {
  const idf::Shape shape{64, 64, 3};
  const auto reference = reference_of_scene(shape);
  ASSERT_TRUE(reference.ok());
  const auto packed = **encode_from(*reference, scene_from(4, 3, shape), 35, kSettings);
  const auto without = unpack_video(packed, frame_of(shape), 3, 3, {});
  EXPECT_EQ(without.status().code(), StatusCode::kDataLoss);
  EXPECT_NE(without.status().message().find("reference"), std::string::npos);
  const auto other = make_reference(scene_with_square(30, shape), 30, kSettings);
  ASSERT_TRUE(other.ok());
  EXPECT_FALSE(unpack_video(packed, frame_of(shape), 3, 3, std::vector{other->reference}).ok());
}

TEST_F(PackedVideo, IsAFormOfImagesInAChain) {
  const idf::Shape shape{64, 64, 3};
  const auto reference = reference_of_scene(shape);
  ASSERT_TRUE(reference.ok());
  const auto images = scene_from(4, 6, shape);
  LatentChainCodec codec{{frame_of(shape)}, {}, {}, {{reference->reference}}};
  LatentRows rows;
  rows.images.resize(1);
  rows.images[0].form = ImageForm::kPackedAv1;
  rows.images[0].video = **encode_from(*reference, images, 35, kSettings);
  const auto chain = codec.encode(rows, 6);
  const auto decoded = codec.decode(chain, 6, 4);
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(decoded->images[0].form, ImageForm::kPackedAv1);
  EXPECT_EQ(decoded->images[0].frames,
            *unpack_video(rows.images[0].video, frame_of(shape), 6, 4, codec.references_of(0)));
  codec.references.clear();
  EXPECT_EQ(codec.decode(chain, 6, 4).status().code(), StatusCode::kDataLoss);
}

TEST_F(PackedVideo, IsSafeOnDamage) {
  const idf::Shape shape{64, 64, 3};
  const auto reference = reference_of_scene(shape);
  ASSERT_TRUE(reference.ok());
  const std::vector references{reference->reference};
  const auto packed = **encode_from(*reference, scene_from(4, 3, shape), 40, kSettings);
  const auto check = [&](std::span<const std::byte> bytes) {
    const auto images = unpack_video(bytes, frame_of(shape), 3, 3, references);
    if (!images.ok()) return;
    ASSERT_EQ(images->size(), 3u);
    for (const idf::NdArray& image : *images) EXPECT_EQ(image.shape(), shape);
  };
  for (size_t size = 0; size < packed.size(); ++size) check(std::span(packed).first(size));
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    auto damaged = packed;
    for (int i = 0; i < 1 + round % 4; ++i)
      damaged[random() % damaged.size()] ^= std::byte(1 << (random() % 8));
    check(damaged);
  }
  for (const FrameShape& frame :
       {frame_of({64, 64}), frame_of({4, 4, 3}), frame_of({1 << 20, 1 << 20, 3}),
        FrameShape{idf::ElementType::kFloat32, {64, 64, 3}}})
    EXPECT_EQ(unpack_video(packed, frame, 3, 3, references).status().code(), StatusCode::kDataLoss);
}

TEST(VideoReferences, AreReadStrictly) {
  VideoReference one{.picture = std::vector<std::byte>(5, std::byte{1}),
                     .key_frame = std::vector<std::byte>(9, std::byte{2}),
                     .time = 1645189615000000000,
                     .key = 33,
                     .is_deep = false,
                     .reach = 12.5};
  VideoReference two = one;
  two.key_frame.push_back(std::byte{3});
  two.is_deep = true;
  EXPECT_NE(one.hash(), two.hash());
  const std::vector references{one, two};
  const auto bytes = to_bytes(references);
  const auto read = references_from(bytes);
  ASSERT_TRUE(read.ok()) << read.status().to_string();
  EXPECT_EQ(*read, references);
  EXPECT_TRUE(references_from(to_bytes({}))->empty());
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(references_from(std::span(bytes).first(size)).status().code(), StatusCode::kDataLoss)
        << size;
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(references_from(longer).ok());
  one.key = 64;
  EXPECT_FALSE(references_from(to_bytes(std::vector{one})).ok());
  one.key = 3;
  one.reach = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(references_from(to_bytes(std::vector{one})).ok());
  EXPECT_FALSE(references_from(to_bytes(std::vector(kMaxReferences + 1, two))).ok());
}

}  // namespace
}  // namespace engram::encoders
