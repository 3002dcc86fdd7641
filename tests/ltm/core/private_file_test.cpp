// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/private_file.h"

#include <sys/stat.h>

#include "ltm/core/file.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

class PrivateFileTest : public ::testing::Test {
 protected:
  PrivateFileTest() { overwrite_file(path_, as_bytes("a secret")); }

  StatusCode opened(mode_t permissions, PrivateFile::Mode mode, SecretReaders readers) {
    EXPECT_EQ(::chmod(path_.c_str(), permissions), 0);
    return PrivateFile::open(path_, mode, readers).status().code();
  }

  std::string text() { return std::string(as_text(read_file(path_)->bytes())); }

  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "secret";
};

using enum PrivateFile::Mode;

TEST_F(PrivateFileTest, IsRefusedIfOthersMayReadOrChangeIt) {
  for (const mode_t mode : {0600U, 0400U, 0700U}) {
    EXPECT_EQ(opened(mode, kRead, SecretReaders::kOwner), StatusCode::kOk) << mode;
    EXPECT_EQ(opened(mode, kRead, SecretReaders::kOwnerAndGroup), StatusCode::kOk) << mode;
  }
  EXPECT_EQ(opened(0640, kRead, SecretReaders::kOwnerAndGroup), StatusCode::kOk);
  EXPECT_EQ(opened(0640, kRead, SecretReaders::kOwner), StatusCode::kFailedPrecondition);
  for (const mode_t mode : {0604U, 0602U, 0601U, 0620U, 0610U}) {
    EXPECT_EQ(opened(mode, kRead, SecretReaders::kOwner), StatusCode::kFailedPrecondition);
    EXPECT_EQ(opened(mode, kRead, SecretReaders::kOwnerAndGroup), StatusCode::kFailedPrecondition);
    EXPECT_EQ(opened(mode, kOverwrite, SecretReaders::kOwner), StatusCode::kFailedPrecondition);
  }
  EXPECT_FAILS(check_private_file(path_), StatusCode::kFailedPrecondition, "chmod 600");
}

TEST_F(PrivateFileTest, IsOverwrittenOnlyIfItsOwnerMayWrite) {
  // Root can open it, but is refused as well.
  EXPECT_EQ(opened(0400, kOverwrite, SecretReaders::kOwner), StatusCode::kFailedPrecondition);
  EXPECT_EQ(opened(0600, kOverwrite, SecretReaders::kOwner), StatusCode::kOk);
  {
    auto file = PrivateFile::open(path_, kOverwrite, SecretReaders::kOwner);
    ASSERT_OK(file);
    EXPECT_EQ(file->size(), 8U);
    ASSERT_OK(file->write_at(2, as_bytes("SECRET")));
    ASSERT_OK(file->sync());
  }
  EXPECT_EQ(text(), "a SECRET");
}

TEST_F(PrivateFileTest, IsAPlainFileAndNoLinkWhereItIsOverwritten) {
  ASSERT_EQ(::chmod(path_.c_str(), 0600), 0);
  const auto link = scratch_ / "link", pipe = scratch_ / "pipe";
  std::filesystem::create_symlink(path_, link);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_OK(PrivateFile::open(link, kRead, SecretReaders::kOwner));
  EXPECT_FAILS(PrivateFile::open(link, kOverwrite, SecretReaders::kOwner), StatusCode::kUnavailable,
               "link");
  EXPECT_FAILS(PrivateFile::open(pipe, kRead, SecretReaders::kOwner),
               StatusCode::kFailedPrecondition, "no plain file");
  EXPECT_FAILS(PrivateFile::open(scratch_.path(), kRead, SecretReaders::kOwner),
               StatusCode::kFailedPrecondition, "no plain file");
  EXPECT_FAILS(PrivateFile::open(scratch_ / "missing", kOverwrite, SecretReaders::kOwner),
               StatusCode::kNotFound, "missing");
}

TEST_F(PrivateFileTest, IsReadUpToABound) {
  ASSERT_EQ(::chmod(path_.c_str(), 0600), 0);
  EXPECT_EQ(*read_private_file(path_, 8), "a secret");
  EXPECT_FAILS(read_private_file(path_, 7), StatusCode::kInvalidArgument, "more than 7 bytes");
}

TEST_F(PrivateFileTest, IsMadeForItsOwnerAlone) {
  EXPECT_FAILS(create_private_file(path_, "another"), StatusCode::kAlreadyExists, "secret");
  EXPECT_EQ(text(), "a secret");
  const auto made = scratch_ / "made";
  ASSERT_OK(create_private_file(made, "another"));
  EXPECT_EQ(*read_private_file(made, 100), "another");
  EXPECT_EQ(std::filesystem::status(made).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

}  // namespace
}  // namespace engram
