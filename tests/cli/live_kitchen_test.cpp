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
    return sensed(store);
  }

  /// What the robot sensed, by path, but when it came. Skills, and maps that are made beside the
  /// kitchen, follow clocks of their own.
  std::map<std::string, std::string> sensed(const std::string& store) const {
    const std::string folder = (directory_ / (store + "-files")).string();
    const RunResult exported =
        run_engram({"export", (directory_ / store).string(), "--to", "armarx", "-o", folder});
    EXPECT_EQ(exported.exit_code, 0) << exported.err;
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      const std::string path = entry.path().lexically_relative(folder);
      if (path.find("RobotState") == std::string::npos &&
          path.find("Vision") == std::string::npos && path.find("Objects") == std::string::npos &&
          path.find("Simulation") == std::string::npos)
        continue;
      std::string text = text_of(entry.path());
      if (entry.path().filename() == "data.json") {
        Json value = Json::parse(text);
        value.erase("arrived_ns");
        text = value.dump();
      }
      files[path] = text;
    }
    return files;
  }

  /// What is sensed while skills are asked for, stopped and hindered in a kitchen whose time is
  /// held, and how they ended.
  std::pair<std::map<std::string, std::string>, std::vector<std::string>> held(
      const std::string& name) const {
    std::ofstream(directory_ / (name + ".yaml"))
        << "servers:\n  - {name: engram, store: " << (directory_ / (name + ".engram")).string()
        << ", skills: {clock: RobotState/Localization/robot/platform}}\nsystem_state: false\n";
    RunningEngram server({"serve", "--config", (directory_ / (name + ".yaml")).string()});
    EXPECT_TRUE(server.wait_for("listens at"));
    RunningEngram kitchen(live({"--stepped", "--held", "--height", "32"}));
    EXPECT_TRUE(kitchen.wait_for("are registered"));
    std::vector<std::string> ends;
    const auto pass = [](const std::string& seconds, bool until_end) {
      const RunResult passed =
          run_engram({"skill", "run", "kitchen/pass", "seconds=" + seconds,
                      std::string("until_end=") + (until_end ? "true" : "false")});
      EXPECT_EQ(passed.exit_code, 0) << passed.out << passed.err;
    };
    const auto begin = [](std::vector<std::string> words) {
      words.insert(words.begin(), {"skill", "run"});
      words.emplace_back("--json");
      auto running = std::make_unique<RunningEngram>(words);
      EXPECT_TRUE(running->wait_for(R"("stage":"started")"));
      return running;
    };
    const auto end = [&](RunningEngram& running) {
      const std::string out = running.end(0).out;
      const Json last = Json::parse(out.substr(out.rfind('\n', out.size() - 2) + 1));
      ends.push_back(last.at("outcome").get<std::string>() + ": " +
                     last.at("reason").get<std::string>() + last.at("result").dump());
    };
    pass("0.25", false);
    auto drive = begin({"kitchen/navigate", "surface=counter"});
    pass("0.6", false);
    const RunResult poked = run_engram({"simulate", "poke", "chair to 0.6,-1.5"});
    EXPECT_EQ(poked.exit_code, 0) << poked.err;
    const RunResult said = run_engram({"commit", "Speech/Commands/human/text", "--data",
                                       R"({"speaker": "Ada", "text": "Stop!"})"});
    EXPECT_EQ(said.exit_code, 0) << said.err;
    pass("60", true);
    end(*drive);
    drive = begin({"kitchen/approach", "object=Objects/Instances/kitchen/salt_box_1"});
    pass("60", true);
    end(*drive);
    // It waits besides until the memory says that the hand holds the object.
    auto pick = begin({"kitchen/pick", "object=Objects/Instances/kitchen/salt_box_1"});
    pass("60", true);
    pass("0.3", false);
    end(*pick);
    EXPECT_EQ(kitchen.end(SIGINT).exit_code, 0);
    EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
    return {sensed(name + ".engram"), ends};
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

TEST_F(LiveKitchen, CarriesOutSkillsEquallyWhileItsTimeIsHeld) {
  const auto [first, first_ends] = held("first");
  const auto [second, second_ends] = held("second");
  EXPECT_GT(first.size(), 300u);
  EXPECT_TRUE(first == second);
  EXPECT_EQ(first_ends, second_ends);
  ASSERT_THAT(first_ends, SizeIs(3));
  EXPECT_THAT(first_ends[0], HasSubstr("stop: its condition does not hold any more"));
  EXPECT_THAT(first_ends[1], HasSubstr("success: 0.0"));
  EXPECT_THAT(first_ends[2], HasSubstr("success: lifted 0.1"));
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
      {{"--stepped", "--seconds", "0"}, "needs --seconds of more than 0"},
      {{"--stepped", "--seconds", "1", "--speed", "2"}, "found --stepped and --speed"},
      {{"--held"}, "--held: needs --stepped"},
      {{"--folder", "x"}, "found --live and --folder"},
      {{"--seed", "1,2"}, "found 2 seeds"},
      {{"--chair", "1"}, "found the place '1'"},
      {{"--bus", "127.0.0.1:0"}, "needs a Unix socket"}};
  for (const auto& [more, message] : cases) {
    const RunResult result = run_engram(live(more));
    EXPECT_NE(result.exit_code, 0) << message;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  for (const auto& option : {std::vector<std::string>{"--stepped"},
                             {"--held"},
                             {"--json"},
                             {"--chair", "1,0"},
                             {"--server", "unix:/tmp/none"}}) {
    std::vector<std::string> words{"simulate", "kitchen", (directory_ / "x.engram").string()};
    words.insert(words.end(), option.begin(), option.end());
    const RunResult result = run_engram(words);
    EXPECT_EQ(result.exit_code, 2) << option.front();
    EXPECT_THAT(result.err, HasSubstr("found " + option.front() + " without --live"));
  }
}

}  // namespace
}  // namespace engram::cli
