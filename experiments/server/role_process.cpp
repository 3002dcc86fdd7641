// SPDX-License-Identifier: Apache-2.0
#include "server/role_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <iostream>

extern char** environ;

namespace engram::experiments {

namespace {

[[noreturn]] void give_up(const std::string& why) {
  std::cerr << why << "\n";
  std::exit(1);
}

}  // namespace

RoleProcess::RoleProcess(std::vector<std::string> words, int shared) {
  std::array<int, 2> in{};
  std::array<int, 2> out{};
  if (::pipe2(in.data(), O_CLOEXEC) != 0 || ::pipe2(out.data(), O_CLOEXEC) != 0) give_up("no pipe");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in[0], 0);
  ::posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  if (shared >= 0) ::posix_spawn_file_actions_adddup2(&actions, shared, kShared);
  words.insert(words.begin(), "/proc/self/exe");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (::posix_spawn(&pid_, "/proc/self/exe", &actions, nullptr, argv.data(), environ) != 0)
    give_up("cannot start a process");
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(in[0]);
  ::close(out[1]);
  to_ = in[1];
  from_ = ::fdopen(out[0], "r");
  if (answer() == "ready") return;
  std::string all;
  for (const std::string& word : words) all += word + " ";
  give_up("did not start: " + all);
}

RoleProcess::~RoleProcess() {
  ::close(to_);
  ::fclose(from_);
  ::waitpid(pid_, nullptr, 0);
}

void RoleProcess::tell(const std::string& line) {
  const std::string text = line + "\n";
  if (::write(to_, text.data(), text.size()) < 0) give_up("a process is gone");
}

std::string RoleProcess::answer() {
  char* line = nullptr;
  size_t size = 0;
  const ssize_t length = ::getline(&line, &size, from_);
  std::string text(line, length > 0 ? static_cast<size_t>(length) - 1 : 0);
  ::free(line);
  return text;
}

}  // namespace engram::experiments
