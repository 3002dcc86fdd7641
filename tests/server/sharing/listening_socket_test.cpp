// SPDX-License-Identifier: Apache-2.0
#include "server/sharing/listening_socket.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <cstring>
#include <fstream>

#include "tests/server/sharing/shared_host.h"

namespace engram::server {
namespace {

using engram::testing::Scratch;

/// Somebody's else socket at a path, as a process leaves it that is killed.
Descriptor bind_other(const std::filesystem::path& path) {
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strcpy(address.sun_path, path.c_str());
  EXPECT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  return socket;
}

TEST(ListeningSocket, ReplacesWhatADeadServerLeft) {
  const Scratch scratch;
  bind_other(scratch / "socket");
  ASSERT_TRUE(std::filesystem::is_socket(scratch / "socket"));
  const auto listening = ListeningSocket::open(scratch / "socket", 0600);
  ASSERT_TRUE(listening.ok()) << listening.status().to_string();
  EXPECT_TRUE(connect_socket(scratch / "socket", 100).ok());
}

TEST(ListeningSocket, LeavesALivingServerAlone) {
  const Scratch scratch;
  const auto first = ListeningSocket::open(scratch / "socket", 0600);
  ASSERT_TRUE(first.ok());
  EXPECT_EQ(ListeningSocket::open(scratch / "socket", 0600).status().code(),
            StatusCode::kFailedPrecondition);
  EXPECT_TRUE(connect_socket(scratch / "socket", 100).ok());
}

TEST(ListeningSocket, LeavesAnotherKindOfServerAlone) {
  const Scratch scratch;
  const Descriptor other = bind_other(scratch / "socket");
  ASSERT_EQ(::listen(other.get(), 1), 0);
  EXPECT_EQ(ListeningSocket::open(scratch / "socket", 0600).status().code(),
            StatusCode::kFailedPrecondition);
  EXPECT_TRUE(std::filesystem::is_socket(scratch / "socket"));
}

TEST(ListeningSocket, ReplacesNoFileOrDirectory) {
  const Scratch scratch;
  std::ofstream(scratch / "file") << "precious";
  std::filesystem::create_directory(scratch / "directory");
  for (const char* name : {"file", "directory"})
    EXPECT_EQ(ListeningSocket::open(scratch / name, 0600).status().code(),
              StatusCode::kFailedPrecondition);
  EXPECT_EQ(std::filesystem::file_size(scratch / "file"), 8u);
}

TEST(ListeningSocket, HasTheModeItWasGivenWhateverTheMask) {
  const Scratch scratch;
  const mode_t before = ::umask(0077);
  const auto listening = ListeningSocket::open(scratch / "socket", 0660);
  ::umask(before);
  ASSERT_TRUE(listening.ok());
  struct stat found {};
  ASSERT_EQ(::stat((scratch / "socket").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0660u);
}

TEST(ListeningSocket, TrustsNoDirectoryThatAnybodyMayChange) {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "open");
  ASSERT_EQ(::chmod((scratch / "open").c_str(), 0777), 0);
  const auto path = scratch / "open" / "socket";
  EXPECT_EQ(ListeningSocket::open(path, 0600).status().code(), StatusCode::kFailedPrecondition);
  ASSERT_EQ(::chmod((scratch / "open").c_str(), 01777), 0);
  EXPECT_TRUE(ListeningSocket::open(path, 0600).ok());
  EXPECT_EQ(ListeningSocket::open(scratch / "none" / "socket", 0600).status().code(),
            StatusCode::kUnavailable);
}

TEST(ListeningSocket, RemovesItsPathAndNoOther) {
  const Scratch scratch;
  {
    auto first = ListeningSocket::open(scratch / "socket", 0600);
    ASSERT_TRUE(first.ok());
    const ListeningSocket moved = std::move(*first);
    EXPECT_TRUE(std::filesystem::exists(scratch / "socket"));
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "socket"));
  EXPECT_TRUE(ListeningSocket::open(scratch / "socket", 0600).ok());
}

}  // namespace
}  // namespace engram::server
