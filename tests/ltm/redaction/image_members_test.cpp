// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/image_members.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace engram::ltm {
namespace {

using idf::ElementType;
using idf::NdArray;
using ::testing::ElementsAre;

std::vector<std::string> paths_of(idf::Data value) {
  std::vector<std::string> paths;
  for (const ImageMember& member : find_images(value).members) paths.push_back(member.path);
  return paths;
}

template <typename T>
NdArray array(idf::Shape shape, T value = {}) {
  int64_t count = 1;
  for (const int64_t size : shape) count *= size;
  return NdArray::take(std::move(shape), std::vector<T>(static_cast<size_t>(count), value));
}

TEST(ImageMembers, AreFoundWhereverTheyAreInAValue) {
  const idf::Data value =
      idf::Dict{{"rgb", array<uint8_t>({48, 64, 3})},
                {"depth", array<float>({48, 64})},
                {"more", idf::List{idf::Dict{{"a/b", array<uint16_t>({48, 64, 1})}}, idf::Data(3)}},
                {"planes", array<float>({3, 48, 64})},
                {"video", array<uint8_t>({5, 48, 64, 3})}};
  EXPECT_THAT(paths_of(value), ElementsAre("rgb", "depth", "more/0/a\\/b", "planes", "video"));
  EXPECT_THAT(paths_of(idf::Data(array<uint8_t>({8, 8, 1}))), ElementsAre(""));
}

TEST(ImageMembers, AreNotSeenInPosesCloudsAndTables) {
  const idf::Data value =
      idf::Dict{{"pose", array<double>({4, 4})},           {"joints", array<float>({100, 7})},
                {"cloud", array<float>({1000, 6})},        {"table", array<double>({500, 20})},
                {"features", array<float>({64, 64, 256})}, {"text", "no image"},
                {"bytes", array<uint8_t>({1000})},         {"empty", array<uint8_t>({0, 0, 3})}};
  EXPECT_THAT(paths_of(value), ElementsAre());
}

TEST(ImageMembers, AreToldFromFilesOfImagesInBytes) {
  const auto encoded = [](const std::string& begin) {
    std::vector<uint8_t> bytes(begin.begin(), begin.end());
    bytes.resize(200);
    idf::Data value = idf::Dict{{"a", idf::List{NdArray::take({200}, bytes)}}};
    return find_images(value).encoded;
  };
  EXPECT_EQ(encoded("\xFF\xD8\xFF\xE0"), "a/0");
  EXPECT_EQ(encoded("\x89PNG\r\n\x1A\n"), "a/0");
  EXPECT_EQ(encoded("RIFF....WEBP"), "a/0");
  EXPECT_EQ(encoded("....ftypavif"), "a/0");
  EXPECT_EQ(encoded("data:image/jpeg;base64,"), "a/0");
  EXPECT_EQ(encoded("what anybody writes"), std::nullopt);
  idf::Data text = std::string("\x89PNG\r\n\x1A\n and so on, as a text");
  EXPECT_TRUE(find_images(text).encoded);
}

TEST(ImageMembers, AreStretchedToBytes) {
  auto depth = array<float>({8, 8, 1}, 1.0f);
  std::vector<float> values(64, 1.0f);
  values[1] = 3.0f;
  values[2] = std::numeric_limits<float>::quiet_NaN();
  values[3] = std::numeric_limits<float>::infinity();
  values[4] = 2.0f;
  depth = NdArray::take({8, 8, 1}, values);
  const auto layout = image_layout_of(depth.type(), depth.shape());
  ASSERT_TRUE(layout);
  const GreyOrRgb seen = pixels_of(depth, *layout, 0);
  EXPECT_EQ(seen.channels, 1);
  EXPECT_THAT(std::vector<uint8_t>(seen.pixels.begin(), seen.pixels.begin() + 5),
              ElementsAre(0, 255, 0, 0, 127));
  const double huge = std::numeric_limits<double>::max();
  std::vector<double> wide(64, -huge);
  wide[0] = huge;
  const NdArray doubles = NdArray::take({8, 8, 1}, wide);
  EXPECT_EQ(pixels_of(doubles, *layout, 0).pixels[0], 255);
  EXPECT_EQ(pixels_of(doubles, *layout, 0).pixels[1], 0);
}

TEST(ImageMembers, ShowPlanesAndTheFourthChannelAsRgb) {
  std::vector<uint8_t> planes(3 * 64), four(4 * 64, 9);
  for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<uint8_t>(i / 64 * 100);
  const NdArray chw = NdArray::take({3, 8, 8}, planes);
  const auto seen = pixels_of(chw, *image_layout_of(chw.type(), chw.shape()), 0);
  EXPECT_EQ(seen.channels, 3);
  EXPECT_THAT(std::vector<uint8_t>(seen.pixels.begin(), seen.pixels.begin() + 3),
              ElementsAre(0, 100, 200));
  const NdArray rgba = NdArray::take({8, 8, 4}, four);
  EXPECT_EQ(pixels_of(rgba, *image_layout_of(rgba.type(), rgba.shape()), 0).pixels.size(), 192u);
}

/// The distinct values of one channel in a part of an RGB image.
size_t values_in(const NdArray& image, const ImagePart& part) {
  std::set<uint8_t> values;
  for (int64_t y = part.top; y < part.bottom; ++y)
    for (int64_t x = part.left; x < part.right; ++x)
      values.insert(image.values<uint8_t>()[static_cast<size_t>((y * image.shape()[1] + x) * 3)]);
  return values.size();
}

TEST(Pixelate, LeavesAtMostEightBlocksAlongASide) {
  std::mt19937 random(1);
  std::vector<uint8_t> noise(200 * 160 * 3);
  for (uint8_t& each : noise) each = static_cast<uint8_t>(random());
  for (const auto& [width, height] : {std::pair{120, 100}, {16, 16}, {8, 120}, {5, 3}, {1, 1}}) {
    NdArray image = NdArray::take({160, 200, 3}, noise);
    const auto layout = *image_layout_of(image.type(), image.shape());
    const ImagePart part{0, 10, 20, 10 + width, 20 + height};
    pixelate(image, layout, {part});
    EXPECT_LE(values_in(image, part), 64u);
    if (width <= kMinBlock && height <= kMinBlock) {
      EXPECT_EQ(values_in(image, part), 1u);
    }
    // Nothing else changes.
    const NdArray given = NdArray::take({160, 200, 3}, noise);
    EXPECT_EQ(image.values<uint8_t>()[(20 * 200 + 9) * 3],
              given.values<uint8_t>()[(20 * 200 + 9) * 3]);
    const size_t right = (20 * 200 + 10 + static_cast<size_t>(width)) * 3;
    EXPECT_EQ(image.values<uint8_t>()[right], given.values<uint8_t>()[right]);
  }
}

TEST(Pixelate, TakesTheMeanOfNumbersOfEveryKind) {
  const auto check = [](auto value, auto other) {
    using T = decltype(value);
    std::vector<T> values(64, value);
    values[0] = other;
    NdArray image = NdArray::take({8, 8, 1}, values);
    pixelate(image, *image_layout_of(image.type(), image.shape()), {{0, 0, 0, 2, 1}});
    return image.values<T>()[0];
  };
  EXPECT_EQ(check(uint8_t{10}, uint8_t{20}), 15);
  EXPECT_EQ(check(int8_t{-10}, int8_t{20}), 5);
  EXPECT_EQ(check(uint16_t{1000}, uint16_t{2000}), 1500);
  EXPECT_EQ(check(int32_t{-1000}, int32_t{2000}), 500);
  EXPECT_EQ(check(std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::max()),
            std::numeric_limits<int64_t>::max());
  EXPECT_EQ(check(std::numeric_limits<uint64_t>::max(), std::numeric_limits<uint64_t>::max()),
            std::numeric_limits<uint64_t>::max());
  EXPECT_EQ(check(1.0f, 2.0f), 1.5f);
  EXPECT_EQ(check(1.0f, std::numeric_limits<float>::quiet_NaN()), 1.0f);
  EXPECT_EQ(check(std::numeric_limits<double>::max(), std::numeric_limits<double>::max()),
            std::numeric_limits<double>::max());
}

TEST(Fill, LeavesZerosInACopy) {
  const NdArray given = array<uint8_t>({3, 16, 16}, 7);
  NdArray image = given;
  fill(image, *image_layout_of(image.type(), image.shape()), {{0, 2, 3, 5, 6}});
  EXPECT_EQ(std::ranges::count(image.values<uint8_t>(), 0), 3 * 3 * 3);
  EXPECT_EQ(std::ranges::count(given.values<uint8_t>(), 0), 0);
}

}  // namespace
}  // namespace engram::ltm
