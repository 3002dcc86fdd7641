// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/image_file.h"

#include <algorithm>
#include <array>

#include "ltm/codec/codec.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

std::vector<std::byte> encoded(std::string_view codec, const idf::NdArray& image) {
  auto file = find_codec(codec)->encode(image);
  EXPECT_OK(file);
  return *std::move(file);
}

TEST(ImageFile, IsDecodedAsItAnnouncesItself) {
  const auto colour = idf::NdArray::take<uint8_t>({1, 2, 3}, {9, 9, 9, 9, 9, 9});
  const auto deep = idf::NdArray::take<uint16_t>({1, 2, 1}, {1, 65535});
  EXPECT_EQ(decode_image_file(encoded("png", colour)).value(), colour);
  EXPECT_EQ(decode_image_file(encoded("png", deep)).value(), deep);
  EXPECT_EQ(decode_image_file(encoded("jpeg", colour))->shape(), colour.shape());
  EXPECT_EQ(announced_image(encoded("jpeg", colour))->codec, "jpeg");
}

/// A palette of two colours, three pixels in one row, of two bits each: 0, 1, 0.
constexpr std::string_view kPalette(
    "\x89PNG\r\n\x1a\n"
    "\0\0\0\x0dIHDR\0\0\0\x03\0\0\0\x01\x02\x03\0\0\0\x66\x8e\xfc\x27"
    "\0\0\0\x06PLTE\x0a\x14\x1e\x28\x32\x3c\xd5\x1b\xb4\xe9"
    "\0\0\0\x0aIDAT\x78\x9c\x63\x10\0\0\0\x12\0\x11\xa5\x56\xc7\x4e"
    "\0\0\0\0IEND\xae\x42\x60\x82",
    85);

TEST(ImageFile, MayHaveAPaletteWhereAnyIsTaken) {
  const auto file = as_bytes(kPalette);
  EXPECT_FALSE(announced_image(file));
  EXPECT_EQ(*decode_any_image_file(file, 3),
            idf::NdArray::take<uint8_t>({1, 3, 3}, {10, 20, 30, 40, 50, 60, 10, 20, 30}));
  EXPECT_FAILS(decode_any_image_file(file, 2), StatusCode::kDataLoss, "3 x 1 pixels");
  for (size_t size = 8; size < file.size(); ++size)
    EXPECT_FALSE(decode_any_image_file(file.first(size), 3).ok()) << size;
  EXPECT_FAILS(decode_any_image_file(as_bytes("GIF89a"), 3), StatusCode::kInvalidArgument,
               "needs a PNG or JPEG file");
}

TEST(ImageFile, IsNotBelievedThatFewBytesAreManyPixels) {
  const auto grey = idf::NdArray::take<uint8_t>({1, 1, 1}, {7});
  auto png = encoded("png", grey);
  png[18] = png[22] = std::byte{0x10};  // 4096 x 4096, with a wrong checksum in any case.
  EXPECT_EQ(decode_any_image_file(png, int64_t{1} << 30).status().code(), StatusCode::kDataLoss);
  auto jpeg = encoded("jpeg", grey);
  const auto frame = std::ranges::search(jpeg, std::array{std::byte{0xff}, std::byte{0xc0}});
  ASSERT_FALSE(frame.empty());
  frame[5] = frame[7] = std::byte{0x70};
  EXPECT_FAILS(decode_any_image_file(jpeg, int64_t{1} << 30), StatusCode::kDataLoss, "hold no");
}

TEST(ImageFile, MayHaveColoursSampledLikeNoOthers) {
  const auto image = idf::NdArray::take<uint8_t>({32, 32, 3}, std::vector<uint8_t>(3072, 90));
  auto jpeg = encoded("jpeg", image);
  const auto frame = std::ranges::search(jpeg, std::array{std::byte{0xff}, std::byte{0xc0}});
  ASSERT_FALSE(frame.empty());
  // Of the third colour twice as many columns as of the second, which has no name.
  const auto sampling = frame.begin() + 17;
  ASSERT_EQ(*sampling, std::byte{0x11});
  *sampling = std::byte{0x21};
  const auto decoded = decode_any_image_file(jpeg, 1024);
  ASSERT_OK(decoded);
  EXPECT_EQ(decoded->shape(), image.shape());
}

TEST(ImageFile, MayBeFilledUpBetweenSegments) {
  const auto grey = idf::NdArray::take<uint8_t>({2, 2, 1}, {5, 5, 5, 5});
  auto file = encoded("jpeg", grey);
  file.insert(file.begin() + 2, 3, std::byte{0xff});
  ASSERT_TRUE(announced_image(file));
  EXPECT_EQ(announced_image(file)->shape, grey.shape());
}

TEST(ImageFile, AnyCutAndAnyChangeIsAnErrorOrAnImage) {
  const auto image = idf::NdArray::take<uint8_t>({4, 4, 3}, std::vector<uint8_t>(48, 7));
  for (const char* codec : {"png", "jpeg"}) {
    const auto file = encoded(codec, image);
    for (size_t size = 0; size < 26; ++size)
      EXPECT_FALSE(decode_image_file(std::span(file).first(size)).ok()) << codec << size;
    for (size_t i = 0; i < file.size(); ++i) {
      auto changed = file;
      changed[i] ^= std::byte{0xff};
      const auto found = decode_image_file(changed);
      if (found.ok()) {
        EXPECT_LE(found->bytes().size(), size_t{1} << 28);
      }
    }
  }
}

TEST(ImageFile, DoesNotTakeWhatIsTooLarge) {
  auto file = encoded("png", idf::NdArray::take<uint8_t>({1, 1, 1}, {7}));
  for (size_t i = 16; i < 24; ++i) file[i] = std::byte{0x7f};
  EXPECT_FAILS(decode_image_file(file), StatusCode::kInvalidArgument, "announces");
  EXPECT_FAILS(decode_image_file({}), StatusCode::kInvalidArgument, "0 bytes");
}

}  // namespace
}  // namespace engram::ltm
