// SPDX-License-Identifier: Apache-2.0
// `engram simulate kitchen --live`: a robot whose drivers are programs of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Json = nlohmann::json;

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class LiveKitchen : public ::testing::Test {
 protected:
  LiveKitchen() {
    ::unsetenv("ENGRAM_SERVER");
    ::unsetenv("ENGRAM_TOKEN");
    ::setenv("XDG_RUNTIME_DIR", directory_.path().c_str(), 1);
  }

  [[nodiscard]] std::vector<std::string> serve(const std::string& store) const {
    return {"serve", (directory_ / store).string(), "--no-system-state"};
  }

  static std::vector<std::string> live(const std::vector<std::string>& more) {
    std::vector<std::string> words{"simulate", "kitchen", "--live", "--fast",
                                   "--width",  "64",      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  /// The programs of the live kitchen of this test whose words have `word`, but zombies.
  [[nodiscard]] std::vector<pid_t> programs(const std::string& word) const {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      pid_t id = 0;
      if (std::from_chars(name.data(), name.data() + name.size(), id).ec != std::errc()) continue;
      const std::string words = text_of(entry.path() / "cmdline");
      if (words.find(directory_.path().string()) != std::string::npos &&
          words.find(word) != std::string::npos)
        found.push_back(id);
    }
    return found;
  }

  /// Waits until there is no driver any more.
  void expect_no_drivers() const {
    for (int i = 0; i < 200 && !programs("kitchen-driver").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_THAT(programs("kitchen-driver"), IsEmpty());
  }

  /// What a stepped run of half a second leaves in a store, by path, but when it came.
  std::map<std::string, std::string> stepped(const std::string& store) const {
    RunningEngram server(serve(store));
    EXPECT_TRUE(server.wait_for("listens at"));
    const RunResult ran = run_engram(live({"--stepped", "--seconds", "0.5", "--chair", "0.6,0",
                                           "--person", "-0.85,0.2", "--seed", "2"}));
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr(R"("images":11.0)"));
    EXPECT_THAT(ran.out, HasSubstr(R"("samples":51.0)"));
    EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
    const std::string folder = (directory_ / (store + "-files")).string();
    const RunResult exported =
        run_engram({"export", (directory_ / store).string(), "--to", "armarx", "-o", folder});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      std::string text = text_of(entry.path());
      if (entry.path().filename() == "data.json") {
        Json value = Json::parse(text);
        value.erase("arrived_ns");
        text = value.dump();
      }
      files[entry.path().lexically_relative(folder)] = text;
    }
    return files;
  }

  ScratchDirectory directory_;
};

TEST_F(LiveKitchen, GivesEqualSnapshotsWhenItIsStepped) {
  const auto first = stepped("first.engram");
  EXPECT_TRUE(first == stepped("second.engram"));
  const auto count = [&](const std::string& part) {
    return std::ranges::count_if(
        first, [&](const auto& file) { return file.first.find(part) != std::string::npos; });
  };
  EXPECT_EQ(count("RobotState/Proprioception/robot/joints/"), 51);
  EXPECT_EQ(count(".png"), 22);
  EXPECT_EQ(count("Objects/Instances/kitchen/chair_1/"), 3);
  EXPECT_EQ(count("Objects/Instances/kitchen/person_1/"), 3);
  EXPECT_EQ(count("Objects/Classes/kitchen/"), 12);
  expect_no_drivers();
}

TEST_F(LiveKitchen, GoesOnWhenADriverOrTheServerIsKilled) {
  RunningEngram kitchen(live({}));
  ASSERT_TRUE(kitchen.wait_for(R"("event":"started")"));
  // Its server comes later.
  ASSERT_TRUE(kitchen.wait_for("no server listens at"));
  const std::string back = "the memory is back";
  {
    RunningEngram server(serve("robot.engram"));
    ASSERT_TRUE(server.wait_for("listens at"));
    ASSERT_TRUE(kitchen.wait_for(back));
    const auto cameras = programs("camera");
    ASSERT_THAT(cameras, SizeIs(1));
    ::kill(cameras.front(), SIGKILL);
    ASSERT_TRUE(kitchen.wait_for(R"("event":"driver ended","driver":"camera","exit_code":137)"));
    const RunResult poked = run_engram({"simulate", "poke", "chair to 0.6,0", "--json"});
    EXPECT_EQ(poked.exit_code, 0) << poked.err;
    EXPECT_EQ(Json::parse(poked.out).at("words"), "the chair is at 0.6,0");
    EXPECT_EQ(server.end(SIGKILL).exit_code, -SIGKILL);
  }
  ASSERT_TRUE(kitchen.wait_for("what is sensed is lost until it is back"));
  const RunResult dog = run_engram({"simulate", "poke", "dog to 1,1"});
  EXPECT_EQ(dog.exit_code, 1);
  EXPECT_THAT(dog.err, HasSubstr("has no 'dog'; it has"));
  RunningEngram server(serve("robot.engram"));
  ASSERT_TRUE(server.wait_for("listens at"));
  const auto latest = [](const std::string& entity) {
    const RunResult asked = run_engram({"query", entity + " @ latest", "--json"});
    return asked.exit_code == 0 ? asked.out : std::string();
  };
  const std::string chair = "Objects/Instances/kitchen/chair_1";
  const auto is_new = [&](const std::string& entity, const std::string& before) {
    for (int i = 0; i < 200; ++i) {
      const std::string now = latest(entity);
      if (!now.empty() && now != before) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  };
  EXPECT_TRUE(is_new(chair, latest(chair)));
  const std::string stereo = "Vision/RGB/head/stereo";
  EXPECT_TRUE(is_new(stereo, latest(stereo)));
  // What it can do is registered, and carried out.
  RunResult drive;
  for (int i = 0; i < 40 && drive.exit_code != 0; ++i) {
    drive = run_engram({"skill", "run", "kitchen/navigate", "surface=counter", "speed=2"});
    std::this_thread::sleep_for(std::chrono::milliseconds(250));
  }
  EXPECT_EQ(drive.exit_code, 0) << drive.err;
  EXPECT_THAT(drive.out + drive.err, HasSubstr("from where it was to be"));
  const RunResult none =
      run_engram({"skill", "run", "kitchen/pick", "object=Objects/Instances/kitchen/dog_1"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.out + none.err, HasSubstr("has no 'dog_1'"));
  // A program without navigation has no such skill.
  if (run_engram({"skill", "ls"}).out.find("kitchen/drive") != std::string::npos) {
    const RunResult nowhere = run_engram({"skill", "run", "kitchen/drive", "to="});
    EXPECT_EQ(nowhere.exit_code, 1);
    EXPECT_THAT(nowhere.out + nowhere.err, HasSubstr("needs the name of a place or thing"));
  }
  const RunResult ended = kitchen.end(SIGINT);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr(R"("event":"ended")"));
  expect_no_drivers();
  const RunResult late = run_engram({"simulate", "poke", "chair away"});
  EXPECT_EQ(late.exit_code, 1);
  EXPECT_THAT(late.err, HasSubstr("no live kitchen at"));
}

TEST_F(LiveKitchen, LeavesNoDriverWhenItIsKilled) {
  RunningEngram kitchen(live({"--bus", "unix:" + (directory_ / "bus.sock").string()}));
  ASSERT_TRUE(kitchen.wait_for("no server listens at"));
  EXPECT_THAT(programs("kitchen-driver"), SizeIs(3));
  EXPECT_EQ(kitchen.end(SIGKILL).exit_code, -SIGKILL);
  expect_no_drivers();
}

TEST_F(LiveKitchen, SaysWhatIsWrong) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--stepped"}, "needs --seconds"},
      {{"--folder", "x"}, "found --live and --folder"},
      {{"--seed", "1,2"}, "found 2 seeds"},
      {{"--chair", "1"}, "found the place '1'"},
      {{"--bus", "127.0.0.1:0"}, "needs a Unix socket"}};
  for (const auto& [more, message] : cases) {
    const RunResult result = run_engram(live(more));
    EXPECT_NE(result.exit_code, 0) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
}

}  // namespace
}  // namespace engram::cli
