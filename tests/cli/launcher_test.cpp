// SPDX-License-Identifier: Apache-2.0
// `engram` as it is installed: what it says itself is what the program says, and all else is the
// program's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path kProgram = ENGRAM_REAL_PROGRAM;
const fs::path kHelp = kProgram.parent_path() / "help";

struct Said {
  int exit_code = -1;
  std::string text;  ///< On stdout and stderr.
};

/// Runs a line of the shell.
Said run(const std::string& line) {
  std::FILE* pipe = ::popen(("{ " + line + "; } 2>&1").c_str(), "r");
  Said said;
  std::array<char, 4096> piece;
  while (const size_t count = std::fread(piece.data(), 1, piece.size(), pipe))
    said.text.append(piece.data(), count);
  const int status = ::pclose(pipe);
  said.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return said;
}

/// The words of each command that has a text: " idf generate" for help.idf.generate.txt.
std::vector<std::string> commands() {
  std::vector<std::string> all;
  for (const auto& entry : fs::directory_iterator(kHelp)) {
    if (!entry.path().filename().string().starts_with("help")) continue;
    std::string words = entry.path().stem().string().substr(std::string("help").size());
    std::ranges::replace(words, '.', ' ');
    all.push_back(words);
  }
  return all;
}

TEST(Launcher, SaysWhatTheProgramSays) {
  const std::vector<std::string> all = commands();
  EXPECT_GT(all.size(), 20u);
  EXPECT_THAT(all, ::testing::IsSupersetOf({"", " query", " idf generate"}));
  for (const std::string& words : all) {
    const Said program = run(kProgram.string() + words + " --help");
    EXPECT_EQ(program.exit_code, 0) << words;
    EXPECT_THAT(program.text, HasSubstr("Usage: engram" + words)) << words;
    EXPECT_EQ(run(ENGRAM_PROGRAM + words + " --help").text, program.text) << words;
  }
  for (const std::string line : {" --version",
                                 "",
                                 " fly",
                                 " --fly query a b c",
                                 " -q",
                                 " idf",
                                 " --version fly",
                                 " fly --help",
                                 " import",
                                 " consolidate",
                                 " query a b c d",
                                 " query a b --sve folder",
                                 " query a b --save",
                                 " query a b --prefer rare",
                                 " query a b --server c --names d",
                                 " import --from a --video b c",
                                 " recover a --output",
                                 " consolidate a --steps many --fly",
                                 " crossval a",
                                 " simulate"}) {
    const Said program = run(kProgram.string() + line);
    const Said launcher = run(ENGRAM_PROGRAM + line);
    EXPECT_EQ(launcher.text, program.text) << line;
    EXPECT_EQ(launcher.exit_code, program.exit_code) << line;
  }
}

/// The launcher as it is installed, with a program beside it that says how it was started.
class Installed : public ::testing::Test {
 protected:
  Installed() {
    fs::create_directories(engram_.parent_path());
    fs::create_directories(program_.parent_path());
    fs::copy_file(ENGRAM_PROGRAM, engram_);
    fs::copy(kHelp, program_.parent_path() / "help", fs::copy_options::recursive);
    std::ofstream(program_) << "#!/bin/sh\necho \"PROGRAM $$ $#: $* ($WORD)\"\ncat\nexit 7\n";
    fs::permissions(program_, fs::perms::owner_all);
  }

  [[nodiscard]] Said engram(const std::string& arguments) const {
    return run("echo typed | WORD=said '" + engram_.string() + "' " + arguments);
  }

  ScratchDirectory directory_;
  const fs::path engram_ = directory_.path() / "bin/engram";
  const fs::path program_ = directory_.path() / "libexec/engram/engram-program";
};

TEST_F(Installed, AnswersWithoutTheProgramWhatNeedsNoneOfIt) {
  for (const std::string line :
       {"--help", "-h", "query --help", "idf generate -h", "--version", "fly", "",
        "query a --sve b", "consolidate", "import a --from b --video c"})
    EXPECT_THAT(engram(line).text, ::testing::Not(HasSubstr("PROGRAM "))) << line;
  EXPECT_EQ(engram("--version").exit_code, 0);
  EXPECT_EQ(engram("query --help").exit_code, 0);
  EXPECT_EQ(engram("fly").exit_code, 2);
}

TEST_F(Installed, BecomesTheProgramForAllElse) {
  const Said said = engram("query 'a b' --json");
  EXPECT_EQ(said.exit_code, 7);
  EXPECT_THAT(said.text, HasSubstr(" 3: query a b --json (said)\ntyped\n"));
  for (const std::string line : {"query", "-q query a", "query --help x", "info --fly --help",
                                 "query a --prefer rare --fly", "recover a --output b"})
    EXPECT_THAT(engram(line).text, HasSubstr("PROGRAM ")) << line;
  fs::remove(program_.parent_path() / "help/help.query.txt");
  for (const std::string line : {"query --help", "query a"})
    EXPECT_THAT(engram(line).text, HasSubstr("PROGRAM ")) << "it has no text: " << line;
  fs::remove(program_.parent_path() / "help/usage.txt");
  EXPECT_THAT(engram("fly").text, HasSubstr("PROGRAM ")) << "what is wrong is not known";
}

TEST_F(Installed, LeavesAllWordsToACommandThatTakesAny) {
  EXPECT_THAT(engram("view --fly").text, ::testing::Not(HasSubstr("PROGRAM ")));
  // As a program without the viewer writes it, whose command says how to get one.
  const fs::path usage = program_.parent_path() / "help/usage.txt";
  std::ifstream stream(usage);
  std::string text, line;
  size_t changed = 0;
  while (std::getline(stream, line)) {
    if (line.starts_with("command\t1\tview\t")) {
      line.back() = '1';
      ++changed;
    }
    text += line + '\n';
  }
  stream.close();
  ASSERT_EQ(changed, 1u);
  std::ofstream(usage) << text;
  EXPECT_THAT(engram("view --fly").text, HasSubstr("PROGRAM "));
}

TEST_F(Installed, KeepsItsProcessAndIsFoundByALink) {
  const fs::path link = directory_.path() / "link";
  fs::create_symlink(engram_, link);
  const Said said = run("'" + link.string() + "' query < /dev/null & pid=$!; wait $pid; echo $pid");
  const size_t begin = said.text.find("PROGRAM ") + std::string("PROGRAM ").size();
  const std::string pid = said.text.substr(begin, said.text.find(' ', begin) - begin);
  EXPECT_THAT(said.text, HasSubstr("\n" + pid + "\n"));
}

TEST_F(Installed, SaysWhatIsMissingWhereThereIsNoProgram) {
  fs::remove(program_);
  const Said said = engram("query a b");
  EXPECT_EQ(said.exit_code, 126);
  EXPECT_THAT(said.text, HasSubstr("cannot start '" + program_.string()));
}

}  // namespace
}  // namespace engram::cli
