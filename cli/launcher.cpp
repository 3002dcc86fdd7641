// SPDX-License-Identifier: Apache-2.0
// The program that is installed as `engram`. The real program is another file, linked with
// everything that records, serves and simulates. The launcher answers what needs none of it
// (--help, --version, unknown options), in the words that the program wrote when it was built, and
// executes the program for everything else.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/learning_environment.h"
#include "cli/old_words.h"
#include "cli/usage.h"

namespace engram::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "engram-program";
constexpr int kWrongUsage = 2;
constexpr int kCannotStart = 126;

/// The folder of the program: that of an installation if it exists, else that of a build.
fs::path program_directory() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path installed = (here / ENGRAM_PROGRAM_DIRECTORY).lexically_normal();
  if (fs::exists(installed / kProgram, error)) return installed;
  return (here / "../libexec/engram").lexically_normal();
}

bool is_help(std::string_view word) {
  return word == "--help" || word == "-h";
}

/// Whether a word can be the name of a command.
bool is_name(std::string_view word) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz-_";
  return !word.empty() && word.front() != '-' &&
         word.find_first_not_of(kLetters) == std::string_view::npos;
}

/// The file with the help text of a command.
std::optional<fs::path> help_file(const fs::path& directory, std::span<char*> command) {
  std::string name = "help";
  for (const std::string_view word : command) {
    if (!is_name(word)) return std::nullopt;
    name.append(".").append(word);
  }
  fs::path file = directory / "help" / (name + ".txt");
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  return file;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The program's message for arguments that it refuses; empty if only the program can decide.
std::string wrong_usage(const fs::path& directory, std::span<char*> words) {
  const std::vector<std::string> given(words.begin(), words.end());
  CLI::App app;
  if (with_todays_words(given).arguments != given ||
      !read_usage(text_of(directory / "help/usage.txt"), app))
    return "";
  return wrong_usage_text(app, given);
}

/// The exit code if the program is not needed.
std::optional<int> answer(const fs::path& directory, std::span<char*> words) {
  if (words.size() == 1 && std::string_view(words[0]) == "--version") {
    std::puts("engram " ENGRAM_VERSION);
    return 0;
  }
  if (!words.empty() && is_help(words.back())) {
    const auto file = help_file(directory, words.first(words.size() - 1));
    const std::string text = file ? text_of(*file) : "";
    if (text.empty()) return std::nullopt;
    std::fwrite(text.data(), 1, text.size(), stdout);
    return 0;
  }
  if (const std::string wrong = wrong_usage(directory, words); !wrong.empty()) {
    std::fputs(wrong.c_str(), stderr);
    return kWrongUsage;
  }
  return std::nullopt;
}

int run(int argc, char** argv) {
  const fs::path directory = program_directory();
  const std::span<char*> all(argv, static_cast<size_t>(argc));
  if (const auto exit_code = answer(directory, all.subspan(std::min<size_t>(1, all.size()))))
    return *exit_code;
  // Set here, because the program would have to execute itself again for it and be loaded twice.
  set_learning_environment(argc, argv);
  const std::string program = directory / kProgram;
  ::execv(program.c_str(), argv);
  std::fprintf(stderr, "engram: cannot start '%s': %s\n", program.c_str(), std::strerror(errno));
  return kCannotStart;
}

}  // namespace

}  // namespace engram::cli

int main(int argc, char** argv) {
  return engram::cli::run(argc, argv);
}
