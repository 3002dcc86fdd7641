// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/child.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

int exit_code_of(pid_t child) {
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Child, WritesWhereItIsToldAndHasNothingToRead) {
  const ScratchDirectory scratch;
  const auto path = scratch / "said";
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  const auto child = start_child(
      {"sh", "-c", "echo \"$0\"; echo err >&2; cat; exit 7", "two words"}, {file, file});
  ::close(file);
  ASSERT_TRUE(child.ok()) << child.status().to_string();
  EXPECT_EQ(exit_code_of(*child), 7);
  std::ifstream said(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(said), {}), "two words\nerr\n");
}

TEST(Child, LeadsAGroupAndBlocksNoSignalThatItsParentBlocks) {
  sigset_t terminate, before;
  sigemptyset(&terminate);
  sigaddset(&terminate, SIGTERM);
  ASSERT_EQ(::pthread_sigmask(SIG_BLOCK, &terminate, &before), 0);
  const auto child = start_child({"sleep", "60"}, {});
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ASSERT_TRUE(child.ok()) << child.status().to_string();
  EXPECT_EQ(::getpgid(*child), *child);
  ASSERT_EQ(::kill(-*child, SIGTERM), 0);
  int status = 0;
  ASSERT_EQ(::waitpid(*child, &status, 0), *child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}

TEST(Child, SaysWhyAProgramCannotBeStarted) {
  const auto child = start_child({"/nowhere/program"}, {});
  EXPECT_EQ(child.status().code(), StatusCode::kUnavailable);
  EXPECT_NE(child.status().message().find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace engram
