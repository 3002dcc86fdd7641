// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/picture_file.h"

#include "tests/memory/prior/prior_directory.h"

namespace engram::memory {
namespace {

using engram::testing::picture_file;

Result<idf::NdArray> read(std::string_view file, int64_t max_pixels = 1'000'000) {
  return read_picture(std::as_bytes(std::span(file)), max_pixels);
}

TEST(PictureFile, HoldsColoursInTheOrderOfImages) {
  const auto picture = read(picture_file(".png", 2, 3, CV_8UC3, {10, 20, 30}));
  ASSERT_OK(picture);
  EXPECT_EQ(picture->shape(), (idf::Shape{2, 3, 3}));
  EXPECT_EQ(picture->values<uint8_t>()[0], 30);
  EXPECT_EQ(picture->values<uint8_t>()[1], 20);
  EXPECT_EQ(picture->values<uint8_t>()[2], 10);
}

TEST(PictureFile, HoldsGreyAndDepth) {
  const auto grey = read(picture_file(".jpg", 16, 8, CV_8UC1, 77));
  ASSERT_OK(grey);
  EXPECT_EQ(grey->shape(), (idf::Shape{16, 8, 1}));
  EXPECT_EQ(grey->type(), idf::ElementType::kUInt8);
  const auto depth = read(picture_file(".png", 2, 2, CV_16UC1, 1234));
  ASSERT_OK(depth);
  EXPECT_EQ(depth->values<uint16_t>()[3], 1234);
}

TEST(PictureFile, RefusesTransparencyAndSixteenBitColours) {
  EXPECT_FAILS(read(picture_file(".png", 2, 2, CV_8UC4, {})), StatusCode::kInvalidArgument,
               "transparency");
  EXPECT_FAILS(read(picture_file(".png", 2, 2, CV_16UC3, {})), StatusCode::kInvalidArgument,
               "RGB of 16 bits");
}

TEST(PictureFile, LooksAtTheSizeBeforeItDecodes) {
  for (const char* ending : {".png", ".jpg"}) {
    const std::string file = picture_file(ending, 100, 200, CV_8UC3, {});
    EXPECT_OK(read(file, 20'000));
    EXPECT_FAILS(read(file, 19'999), StatusCode::kInvalidArgument, "200 x 100 pixels");
  }
  std::string huge = picture_file(".png", 2, 2, CV_8UC1, 0);
  for (size_t i = 16; i < 24; ++i) huge[i] = '\x7f';
  EXPECT_FAILS(read(huge, INT64_MAX / 4), StatusCode::kInvalidArgument, "picture");
  EXPECT_FAILS(read(huge), StatusCode::kInvalidArgument, "picture");
}

TEST(PictureFile, RefusesWhatIsNone) {
  for (const std::string& bytes : std::vector<std::string>{
           "", "x", "\xff\xd8", "\xff\xd8\xff", std::string(1000, '\xff'), "\x89PNG\r\n\x1a\n",
           std::string("\xff\xd8\xff\xe0\0\0", 6), "GIF89a" + std::string(100, 'x')})
    EXPECT_FAILS(read(bytes), StatusCode::kInvalidArgument, "");
  for (const char* ending : {".png", ".jpg"}) {
    const std::string file = picture_file(ending, 64, 64, CV_8UC3, {1, 2, 3});
    for (size_t size = 0; size < file.size(); size += 7)
      EXPECT_FALSE(read(file.substr(0, size)).ok()) << ending << " " << size;
  }
}

}  // namespace
}  // namespace engram::memory
