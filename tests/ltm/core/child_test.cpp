// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/child.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

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
  EXPECT_EQ(child.status().code(), StatusCode::kNotFound);
  EXPECT_NE(child.status().message().find("No such file"), std::string::npos);
  EXPECT_EQ(start_child({"/"}, {}).status().code(), StatusCode::kUnavailable);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left of them";
}

TEST(Child, ReadsWhatItIsToldAndNoOtherFile) {
  std::array<int, 2> in{}, out{}, open{};
  ASSERT_EQ(::pipe2(in.data(), O_CLOEXEC), 0);
  ASSERT_EQ(::pipe2(out.data(), O_CLOEXEC), 0);
  ASSERT_EQ(::pipe(open.data()), 0);
  const std::string file = "/proc/self/fd/" + std::to_string(open[1]);
  const auto child =
      start_child({"sh", "-c", "cat; test -e " + file + "; echo $?"}, {out[1], {}, in[0]});
  for (const int fd : {in[0], out[1], open[0], open[1]}) ::close(fd);
  ASSERT_TRUE(child.ok()) << child.status().to_string();
  ASSERT_EQ(::write(in[1], "given ", 6), 6);
  ::close(in[1]);
  std::string said;
  std::array<char, 100> bytes{};
  for (ssize_t got = 0; (got = ::read(out[0], bytes.data(), bytes.size())) > 0;)
    said.append(bytes.data(), static_cast<size_t>(got));
  ::close(out[0]);
  EXPECT_EQ(exit_code_of(*child), 0);
  EXPECT_EQ(said, "given 1\n");
}

TEST(Child, DiesWithTheThreadThatStartedItIfThatIsItsLife) {
  for (const ChildLife life : {ChildLife::kItsOwn, ChildLife::kWithThread}) {
    pid_t child = -1;
    std::thread([&child, life] { child = *start_child({"sleep", "60"}, {}, life); }).join();
    ASSERT_GT(child, 0);
    if (life == ChildLife::kItsOwn) {
      EXPECT_EQ(::waitpid(child, nullptr, WNOHANG), 0);
      ::kill(child, SIGTERM);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), life == ChildLife::kItsOwn ? SIGTERM : SIGKILL);
  }
}

}  // namespace
}  // namespace engram
