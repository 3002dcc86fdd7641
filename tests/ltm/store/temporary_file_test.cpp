// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/temporary_file.h"

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

TEST(TemporaryFile, GoesWithItsOwner) {
  const ScratchDirectory scratch;
  std::filesystem::path path;
  {
    TemporaryFile first = *TemporaryFile::create(scratch.path(), ".h5");
    path = first.path();
    EXPECT_EQ(path.parent_path(), scratch / "tmp");
    EXPECT_EQ(path.extension(), ".h5");
    EXPECT_NE(TemporaryFile::create(scratch.path(), ".h5")->path(), path);
    ASSERT_OK(replace_file(path, as_bytes("content")));
    const TemporaryFile second = std::move(first);
    EXPECT_TRUE(std::filesystem::exists(second.path()));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(TemporaryFile, StaysWhereItWasPublished) {
  const ScratchDirectory scratch;
  {
    const TemporaryFile file = *TemporaryFile::create(scratch.path(), ".h5");
    ASSERT_OK(replace_file(file.path(), as_bytes("content")));
    ASSERT_OK(publish_file(file.path(), scratch / "published"));
  }
  EXPECT_TRUE(std::filesystem::exists(scratch / "published"));
}

TEST(TemporaryFile, BelongsToALivingProcess) {
  const ScratchDirectory scratch;
  const auto path = *temporary_file(scratch.path(), "");
  EXPECT_FALSE(belongs_to_dead_process(path.filename().string()));
  EXPECT_TRUE(belongs_to_dead_process("2147483647-0.h5"));
  EXPECT_TRUE(belongs_to_dead_process("no number"));
}

}  // namespace
}  // namespace engram::ltm
