// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/file.h"

#include <sys/stat.h>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

std::string text_of(const std::filesystem::path& path) {
  const auto content = read_file(path);
  EXPECT_OK(content);
  return content.ok() ? std::string(as_text(content->bytes())) : "";
}

TEST(File, AppendsAndReads) {
  const ScratchDirectory scratch;
  auto file = File::open(scratch / "a", File::Mode::kCreate);
  ASSERT_OK(file);
  ASSERT_OK(file->append(as_bytes("hello ")));
  ASSERT_OK(file->append(as_bytes("world")));
  ASSERT_OK(file->sync());
  EXPECT_EQ(*file->size(), 11u);
  std::vector<std::byte> part(5);
  ASSERT_OK(file->read_at(6, part));
  EXPECT_EQ(as_text(part), "world");
  EXPECT_FAILS(file->read_at(8, part), StatusCode::kDataLoss, "ends at byte 11, needs 2 more");
  ASSERT_OK(file->truncate(5));
  EXPECT_EQ(text_of(scratch / "a"), "hello");
  auto again = File::open(scratch / "a", File::Mode::kAppend);
  ASSERT_OK(again->append(as_bytes("!")));
  EXPECT_EQ(text_of(scratch / "a"), "hello!");
}

TEST(File, NamesWhatItCannotOpen) {
  const ScratchDirectory scratch;
  EXPECT_FAILS(File::open(scratch / "none", File::Mode::kRead), StatusCode::kNotFound, "none");
  ASSERT_OK(File::open(scratch / "a", File::Mode::kCreate));
  EXPECT_FAILS(File::open(scratch / "a", File::Mode::kCreate), StatusCode::kAlreadyExists, "a");
  EXPECT_FAILS(File::open(scratch / "a/b", File::Mode::kAppend), StatusCode::kUnavailable, "a/b");
  auto read_only = File::open(scratch / "a", File::Mode::kRead);
  EXPECT_FAILS(read_only->append(as_bytes("x")), StatusCode::kUnavailable, "cannot write");
}

TEST(File, RefusesAtOnceWhatIsNoRegularFile) {
  const ScratchDirectory scratch;
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  for (const auto mode : {File::Mode::kRead, File::Mode::kAppend})
    EXPECT_FAILS(File::open(scratch / "pipe", mode), StatusCode::kUnavailable,
                 "found a named pipe, needs a regular file");
  EXPECT_FAILS(read_file("/dev/zero"), StatusCode::kUnavailable, "found a device");
  EXPECT_FAILS(read_file(scratch.path()), StatusCode::kUnavailable, "found a directory");
}

TEST(File, LocksOutOthersUntilItGoes) {
  const ScratchDirectory scratch;
  auto other = File::open(scratch / "lock", File::Mode::kAppend);
  {
    auto file = File::open(scratch / "lock", File::Mode::kAppend);
    EXPECT_TRUE(*file->lock(false));
    EXPECT_FALSE(*other->lock(false));
    const File moved = *std::move(file);
    EXPECT_FALSE(*other->lock(false));
  }
  EXPECT_TRUE(*other->lock(true));
}

TEST(File, ReplacesAFileAsAWhole) {
  const ScratchDirectory scratch;
  ASSERT_OK(replace_file(scratch / "a", as_bytes("first")));
  const auto old = File::open(scratch / "a", File::Mode::kRead);
  // What an earlier attempt left behind is no obstacle.
  ASSERT_OK(replace_file(scratch / "a.new", as_bytes("junk of a killed process")));
  ASSERT_OK(replace_file(scratch / "a", as_bytes("second")));
  EXPECT_EQ(text_of(scratch / "a"), "second");
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.new"));
  std::vector<std::byte> bytes(5);
  ASSERT_OK(old->read_at(0, bytes));
  EXPECT_EQ(as_text(bytes), "first");
  EXPECT_FAILS(replace_file(scratch / "no/a", as_bytes("x")), StatusCode::kNotFound, "no/a");
}

TEST(File, PublishesUnderTheFinalName) {
  const ScratchDirectory scratch;
  ASSERT_OK(make_directories(scratch / "x/y"));
  ASSERT_OK(make_directories(scratch / "x/y"));
  ASSERT_OK(replace_file(scratch / "a", as_bytes("text")));
  ASSERT_OK(publish_file(scratch / "a", scratch / "x/y/b"));
  EXPECT_EQ(text_of(scratch / "x/y/b"), "text");
  EXPECT_FALSE(std::filesystem::exists(scratch / "a"));
  EXPECT_FAILS(publish_file(scratch / "a", scratch / "c"), StatusCode::kNotFound, "a");
  ASSERT_OK(remove_file(scratch / "x/y/b"));
  ASSERT_OK(remove_file(scratch / "x/y/b"));
  EXPECT_FAILS(make_directories("/dev/null/x"), StatusCode::kUnavailable, "/dev/null/x");
  EXPECT_FAILS(sync_directory(scratch / "none"), StatusCode::kNotFound, "none");
}

}  // namespace
}  // namespace engram
