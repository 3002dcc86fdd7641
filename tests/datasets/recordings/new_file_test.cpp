// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/new_file.h"

#include <fstream>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

std::string content_of(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : bytes.status().to_string();
}

TEST(NewFile, AppearsOnceItIsPublished) {
  const ScratchDirectory scratch;
  const auto path = scratch / "folder/file";
  auto file = NewFile::create(path);
  ASSERT_OK(file);
  ASSERT_OK(file->append("0000 and "));
  ASSERT_OK(file->append("more"));
  ASSERT_OK(file->overwrite(1, "12"));
  ASSERT_OK(file->append("."));
  EXPECT_EQ(file->size(), 14U);
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_OK(file->publish());
  EXPECT_EQ(content_of(path), "0120 and more.");
  EXPECT_FALSE(std::filesystem::exists(scratch / "folder/file.part"));
}

TEST(NewFile, LeavesNothingWhereItIsNotPublished) {
  const ScratchDirectory scratch;
  {
    auto file = NewFile::create(scratch / "file");
    ASSERT_OK(file);
    ASSERT_OK(file->append("half"));
    const NewFile moved = *std::move(file);
    EXPECT_TRUE(std::filesystem::exists(scratch / "file.part"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(NewFile, ReplacesWhatAKilledProgramLeftAndNothingElse) {
  const ScratchDirectory scratch;
  std::ofstream(scratch / "file.part") << "left behind";
  auto file = NewFile::create(scratch / "file");
  ASSERT_OK(file);
  ASSERT_OK(file->publish());
  EXPECT_EQ(content_of(scratch / "file"), "");
  EXPECT_FAILS(NewFile::create(scratch / "file"), StatusCode::kAlreadyExists, "file'");
}

}  // namespace
}  // namespace engram::datasets
