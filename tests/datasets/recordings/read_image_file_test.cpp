// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/read_image_file.h"

#include "datasets/recordings/folder_file.h"
#include "ltm/codec/codec.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

std::vector<std::byte> encoded(std::string_view codec, const idf::NdArray& image) {
  auto file = ltm::find_codec(codec)->encode(image);
  EXPECT_OK(file);
  return *std::move(file);
}

TEST(ImageFile, ReadsPngAndJpegAsTheyAnnounceThemselves) {
  const ScratchDirectory scratch;
  const auto colour = idf::NdArray::take<uint8_t>({1, 2, 3}, {9, 9, 9, 9, 9, 9});
  const auto deep = idf::NdArray::take<uint16_t>({1, 2, 1}, {1, 65535});
  overwrite_file(scratch / "a.png", encoded("png", colour));
  overwrite_file(scratch / "b.png", encoded("png", deep));
  overwrite_file(scratch / "c.jpg", encoded("jpeg", colour));
  EXPECT_EQ(read_image_file(scratch / "a.png").value(), colour);
  EXPECT_EQ(read_image_file(scratch / "b.png").value(), deep);
  EXPECT_EQ(read_image_file(scratch / "c.jpg")->shape(), colour.shape());
}

TEST(ImageFile, EveryCutAndOtherFileIsAnErrorThatNamesIt) {
  const ScratchDirectory scratch;
  const auto image = idf::NdArray::take<uint8_t>({4, 4, 1}, std::vector<uint8_t>(16, 7));
  const auto file = encoded("png", image);
  for (size_t size = 0; size + 20 < file.size(); ++size) {
    overwrite_file(scratch / "cut.png", std::span(file).first(size));
    const auto found = read_image_file(scratch / "cut.png");
    ASSERT_FALSE(found.ok()) << size;
    EXPECT_THAT(found.status().message(), ::testing::HasSubstr("cut.png'"));
  }
  auto huge = file;
  for (size_t i = 16; i < 24; ++i) huge[i] = std::byte{0x7f};
  overwrite_file(scratch / "huge.png", huge);
  EXPECT_FAILS(read_image_file(scratch / "huge.png"), StatusCode::kInvalidArgument, "announces");
  EXPECT_FAILS(read_image_file(scratch / "none.png"), StatusCode::kNotFound, "none.png");
}

TEST(FolderFile, StaysInTheFolder) {
  const ScratchDirectory scratch;
  std::filesystem::create_directories(scratch / "in/sub");
  overwrite_file(scratch / "in/sub/a", {});
  overwrite_file(scratch / "out", {});
  std::filesystem::create_symlink("sub/a", scratch / "in/link");
  std::filesystem::create_symlink("../out", scratch / "in/leak");
  EXPECT_OK(file_in_folder(scratch / "in", "sub/a"));
  EXPECT_OK(file_in_folder(scratch / "in", "link"));
  for (const char* name : {"", "/etc/passwd", "../out", "sub/../../out", "leak", "sub"})
    EXPECT_EQ(file_in_folder(scratch / "in", name).status().code(), StatusCode::kInvalidArgument)
        << name;
  EXPECT_FAILS(file_in_folder(scratch / "in", "none"), StatusCode::kNotFound, "none");
}

}  // namespace
}  // namespace engram::datasets
