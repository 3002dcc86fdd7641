// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/image_file.h"

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
