// SPDX-License-Identifier: Apache-2.0
// Servers as people start them and talk to them: by the program itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using Json = nlohmann::json;

constexpr const char* kCup = "Objects/Things/kitchen/cup";

class Server : public ::testing::Test {
 protected:
  Server() {
    // What the person who runs the tests has set is not meant.
    ::unsetenv("ENGRAM_SERVER");
    ::unsetenv("ENGRAM_TOKEN");
    ::setenv("XDG_RUNTIME_DIR", directory_.path().c_str(), 1);
  }

  void write(const std::string& name, const std::string& text) const {
    overwrite_file(directory_ / name, std::as_bytes(std::span(text)));
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (directory_ / name).string();
  }
  [[nodiscard]] std::string at(const std::string& name) const { return "unix:" + path(name); }

  static RunResult commit(const std::string& entity, const std::string& data,
                          const std::string& time, const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"commit", entity, "--data", data, "--time", time};
    all.insert(all.end(), more.begin(), more.end());
    return run_engram(all);
  }

  static Json json_of(const RunResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }

  ScratchDirectory directory_;
};

TEST_F(Server, KeepsWhatItAcknowledgedAsDurableWhenItIsKilled) {
  const std::vector<std::string> serve{"serve", path("robot.engram"), "--no-system-state"};
  {
    RunningEngram server(serve);
    ASSERT_TRUE(server.wait_for("listens at " + at("engram.sock")));
    EXPECT_EQ(commit(kCup, "{\"height\": 1}", "1000", {"--durability", "journal"}).exit_code, 0);
    EXPECT_EQ(commit(kCup, "{\"height\": 2}", "2000", {"--durability", "journal"}).exit_code, 0);
    EXPECT_EQ(server.end(SIGKILL).exit_code, -SIGKILL);
  }
  RunningEngram again(serve);
  ASSERT_TRUE(again.wait_for("listens at"));
  const Json all = json_of(run_engram({"query", std::string(kCup) + " @ all", "--json"}));
  const Json& snapshots = all.at("entities").at(0).at("snapshots");
  ASSERT_THAT(snapshots, SizeIs(2));
  EXPECT_EQ(snapshots[1].at("instances")[0].at("data").at("height"), 2);
  const RunResult ended = again.end(SIGTERM);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("stopped"));
  const RunResult none = run_engram({"info"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("ENGRAM_SERVER"));
}

TEST_F(Server, ForgetsWhatItHoldsAndWhatItStored) {
  constexpr const char* kCanary = "canary-that-nobody-may-find-again";
  const auto has_canary = [this] {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path("robot.engram"))) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(file)), {});
      if (bytes.find(kCanary) != std::string::npos) return true;
    }
    return false;
  };
  const std::string value = R"({"said": ")" + std::string(kCanary) + "\"}";
  RunningEngram server({"serve", path("robot.engram"), "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  ASSERT_EQ(commit(kCup, value, "1000", {"--durability", "journal"}).exit_code, 0);
  ASSERT_EQ(commit(kCup, value, "2000").exit_code, 0);
  ASSERT_EQ(commit("Objects/Things/kitchen/plate", R"({"height": 1})", "1000").exit_code, 0);
  EXPECT_TRUE(has_canary());

  const std::vector<std::string> forget{"forget", "--server", at("engram.sock"), kCup};
  const auto with = [&forget](const std::vector<std::string>& more) {
    std::vector<std::string> words = forget;
    words.insert(words.end(), more.begin(), more.end());
    return run_engram(words);
  };
  const RunResult counted = with({"Objects/Things/kitchen/plate @ latest", "--dry-run"});
  EXPECT_EQ(counted.exit_code, 0) << counted.err;
  EXPECT_THAT(counted.out, HasSubstr("In all 3 snapshots"));
  const RunResult asked = with({});
  EXPECT_EQ(asked.exit_code, 2) << "nobody to ask";
  EXPECT_THAT(asked.err, HasSubstr("--yes"));
  EXPECT_EQ(with({"--json"}).exit_code, 2);
  // The command of the store says what it does not reach.
  EXPECT_THAT(run_engram({"forget", path("robot.engram"), kCup, "--dry-run"}).err,
              HasSubstr("--server lets it forget"));

  const Json done = json_of(with({"--erase", "--yes", "--json"}));
  EXPECT_EQ(done.at("plan").at("snapshots"), 2);
  EXPECT_EQ(done.at("done").at("snapshots"), 2);
  EXPECT_EQ(done.at("done").at("from_memory"), 2);
  EXPECT_THAT(done.at("done").at("erased").at("report").get<std::string>(),
              HasSubstr("erasures/000001"));
  EXPECT_FALSE(has_canary());
  EXPECT_EQ(run_engram({"query", std::string(kCup) + " @ all"}).exit_code, 1);
  const RunResult again = with({"--yes"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.err, HasSubstr("names no snapshot"));
  EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
  EXPECT_FALSE(has_canary());
  EXPECT_EQ(json_of(run_engram({"query", path("robot.engram"), "Objects @ all", "--json"}))
                .at("entities")
                .size(),
            1u);

  EXPECT_THAT(with({"--yes"}).err, HasSubstr("no server listens"));
  EXPECT_EQ(run_engram({"forget", "--server", at("engram.sock"), "--yes"}).exit_code, 2);
  EXPECT_EQ(with({"--config", path("forget.yaml"), "--yes"}).exit_code, 2);
  EXPECT_EQ(run_engram({"forget", "--yes"}).exit_code, 2);
  EXPECT_EQ(run_engram({"forget", "--names", at("n"), kCup, "--yes"}).exit_code, 2);
}

TEST_F(Server, ErasesWhatAModelLearnedFrom) {
  std::string lines;
  for (int i = 0; i < 400; ++i)
    lines += R"({"entity": "Robot/Joints/arm/left", "time": )" +
             std::to_string(1'000'000'000 + i * 100'000'000LL) + R"(, "data": {"x": )" +
             std::to_string(0.5 * (i % 20)) + "}}\n";
  write("lines.jsonl", lines);
  const std::string store = path("robot.engram");
  ASSERT_EQ(run_engram({"commit", "--db", store, "--lines", path("lines.jsonl")}).exit_code, 0);
  ASSERT_EQ(run_engram({"consolidate", store, "--budget", "4s", "--threads", "1"}).exit_code, 0);
  ASSERT_FALSE(std::filesystem::is_empty(store + "/models"));
  RunningEngram server({"serve", store, "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  const std::vector<std::string> predict{"predict", "Robot/Joints/arm/left", "--horizons", "1"};
  EXPECT_EQ(run_engram(predict).exit_code, 0);
  const Json done = json_of(run_engram({"forget", "--server", at("engram.sock"),
                                        "Robot @ index:100..149", "--erase", "--yes", "--json"}));
  EXPECT_EQ(done.at("done").at("from_store"), 50);
  const Json& entity = done.at("done").at("erased").at("entities").at(0);
  EXPECT_EQ(entity.at("models_removed").at(0), "v1");
  EXPECT_TRUE(std::filesystem::is_empty(store + "/models"));
  EXPECT_EQ(run_engram(predict).exit_code, 0);
  EXPECT_EQ(server.end(SIGTERM).exit_code, 0);
  EXPECT_EQ(run_engram({"check", store}).exit_code, 0);
}

TEST_F(Server, IsAskedAndWatchedAndCounts) {
  RunningEngram server({"serve", path("robot.engram"), "--listen", "127.0.0.1:0", "--json", "--log",
                        "json", "--no-system-state"});
  ASSERT_TRUE(server.wait_for("\"endpoints\""));
  ASSERT_TRUE(server.wait_for("}\n"));
  // The system chose the port.
  const Json served = Json::parse(server.out());
  const auto endpoint = served.at("servers").at(0).at("endpoints").at(0).get<std::string>();
  ::setenv("ENGRAM_SERVER", endpoint.c_str(), 1);
  RunningEngram watch({"watch", "Objects", "--data", "--json", "--count", "2"});
  ASSERT_TRUE(watch.wait_for("watching"));
  ASSERT_EQ(commit("Robot/Joints/arm/left", "[1, 2]", "500").exit_code, 0);
  const RunResult first = commit(kCup, "{\"height\": 0.25}", "1000");
  EXPECT_EQ(first.out, std::string(kCup) + "/1970-01-01 00:00:00.000001\n");
  ASSERT_EQ(commit(kCup, "{\"height\": 0.5}", "2000").exit_code, 0);
  const RunResult watched = watch.end(0);
  EXPECT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_THAT(watched.out, HasSubstr("\"data\":{\"height\":0.25}"));
  EXPECT_THAT(watched.out, Not(HasSubstr("Joints")));

  // What was watched can be committed, here to where it came from.
  write("lines.jsonl", watched.out + "{\"entity\": \"" + kCup +
                           "\", \"time\": 3000, \"data\": {\"height\": 0.75}}\n");
  const Json many = json_of(run_engram({"commit", "--lines", path("lines.jsonl"), "--json"}));
  EXPECT_EQ(many.at("committed"), 3);

  const RunResult shown = run_engram({"query", "Objects @ all"});
  EXPECT_THAT(shown.out, HasSubstr("{\"height\":0.75}"));
  EXPECT_EQ(run_engram({"query", "?ids Objects @ latest"}).out,
            std::string(kCup) + "/1970-01-01 00:00:00.000003/0\n");
  const Json ahead = json_of(run_engram({"predict", kCup, "--horizons", "1..2", "--json"}));
  ASSERT_THAT(ahead.at("predictions"), SizeIs(2));
  const Json& predicted = ahead.at("predictions").at(1).at("predicted");
  EXPECT_EQ(predicted.at("source"), "predicted");
  EXPECT_EQ(predicted.at("time_ns"), 5000);
  // From an earlier moment, beside what came.
  const Json then = json_of(run_engram({"predict", kCup, "--at", "2000", "--horizons", "1",
                                        "--engine", "constant-velocity", "--compare", "--json"}));
  EXPECT_EQ(then.at("from_ns"), 2000);
  const Json& came = then.at("predictions").at(0);
  EXPECT_EQ(came.at("predicted").at("instances").at(0).at("data").at("height"), 0.75);
  EXPECT_EQ(came.at("error").at("rmse"), 0);
  EXPECT_EQ(came.at("copy_last").at("error").at("rmse"), 0.25);
  EXPECT_EQ(run_engram({"predict", kCup, "--every", "2"}).exit_code, 2);
  const auto listed = [](std::vector<std::string> more) {
    std::vector<std::string> words{"predict", kCup, "--list", "--horizons", "1", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json_of(run_engram(words));
  };
  EXPECT_NE(listed({"--at", "2000"}), listed({})) << "nothing after it is looked at";
  EXPECT_EQ(listed({"--at", "3000"}), listed({})) << "the newest moment";
  EXPECT_THAT(run_engram({"predict", kCup, "--plan", "Robot/Joints/arm/left"}).err,
              HasSubstr("starts from no other entity"));

  const Json info = json_of(run_engram({"info", "--json"}));
  EXPECT_EQ(info.at("figures").at("memory_snapshots"), 4);
  EXPECT_THAT(run_engram({"info"}).out, HasSubstr("working memory"));
  EXPECT_THAT(run_engram({"info", "--metrics"}).out, HasSubstr("\nengram_memory_snapshots 4\n"));
  const RunResult ended = server.end(SIGTERM);
  EXPECT_EQ(ended.exit_code, 0);
  EXPECT_THAT(ended.err, HasSubstr("\"level\":\"info\",\"message\":\"server 'engram' stopped"));
}

TEST_F(Server, IsFoundByTheNameSystem) {
  RunningEngram names({"mns", "--listen", at("n")});
  ASSERT_TRUE(names.wait_for("Name system listens"));
  write("robot.yaml", "names: {at: '" + at("n") + "'}\nservers:\n" +
                          "  - {name: a, memories: [Objects], listen: '" + at("a") + "'}\n" +
                          "  - {name: b, memories: [Robot], listen: '" + at("b") + "'}\n");
  RunningEngram server({"serve", "--config", path("robot.yaml")});
  ASSERT_TRUE(server.wait_for("Server b listens"));
  write("lines.jsonl",
        "{\"entity\": \"Objects/a/b/c\", \"data\": 1}\n\n"
        "{\"entity\": \"Robot/a/b/c\", \"data\": 2}\n");
  // Servers need a moment to be registered.
  for (int i = 0; i < 50; ++i)
    if (const RunResult known = run_engram({"info", "--names", at("n"), "--json"});
        Json::parse(known.out, nullptr, false).at("servers").size() == 2)
      break;
  EXPECT_EQ(run_engram({"commit", "--lines", path("lines.jsonl"), "--names", at("n")}).out,
            "2 snapshots committed\n");
  const RunResult all = run_engram({"query", ".* @ latest", "--names", at("n")});
  EXPECT_THAT(all.out, HasSubstr("Objects/a/b/c"));
  EXPECT_THAT(all.out, HasSubstr("Robot/a/b/c"));
  EXPECT_EQ(run_engram({"query", "Grasp @ latest", "--names", at("n")}).exit_code, 1);
  EXPECT_THAT(run_engram({"predict", "Robot/a/b/c", "--horizons", "+1s", "--names", at("n")}).out,
              HasSubstr("Robot/a/b/c"));
  EXPECT_THAT(run_engram({"predict", "Robot/a/b/d", "--list", "--names", at("n")}).err,
              HasSubstr("Robot/a/b/d"));
  RunningEngram watch({"watch", "--names", at("n"), "--count", "2"});
  ASSERT_TRUE(watch.wait_for("watching"));
  EXPECT_EQ(commit("Robot/a/b/c", "3", "1", {"--names", at("n")}).exit_code, 0);
  EXPECT_EQ(commit("Objects/a/b/c", "3", "1", {"--names", at("n")}).exit_code, 0);
  const RunResult watched = watch.end(0);
  EXPECT_THAT(watched.out, HasSubstr("Robot/a/b/c"));
  EXPECT_THAT(watched.out, HasSubstr("Objects/a/b/c"));
}

TEST_F(Server, TakesTypesAndRefusesWhatBreaksThem) {
  write("cup.xml", R"(<AronTypeDefinition><GenerateTypes><Object name="kitchen::Cup">
    <ObjectChild key="height"><Float32 unit="m" min="0" /></ObjectChild>
    <ObjectChild key="middle"><Matrix rows="3" cols="1" type="float32" /></ObjectChild>
    </Object></GenerateTypes></AronTypeDefinition>)");
  RunningEngram server({"serve", path("robot.engram"), "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  const RunResult typed = commit(kCup, "{\"height\": 0.5, \"middle\": [[1], [2], [3]]}", "1000",
                                 {"--types", path("cup.xml")});
  EXPECT_EQ(typed.exit_code, 0) << typed.err;
  EXPECT_EQ(typed.err, "");
  const std::string flat = "{\"height\": 0.5, \"middle\": [[1], [2], [3]]}";
  const RunResult named = commit(kCup, flat, "1500", {"--types", path("cup.xml"), "--type", "Mug"});
  EXPECT_EQ(named.exit_code, 1);
  EXPECT_THAT(named.err, HasSubstr("Mug"));
  const RunResult old =
      commit(kCup, flat, "1500", {"--type=" + path("cup.xml"), "--type-name", "kitchen::Cup"});
  EXPECT_EQ(old.exit_code, 0) << old.err;
  EXPECT_THAT(old.err, HasSubstr("'--type' is '--types' now"));
  EXPECT_THAT(old.err, HasSubstr("'--type-name' is '--type' now"));
  const RunResult broken = commit(kCup, "{\"width\": 1}", "2000");
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.err, HasSubstr("height"));
}

TEST_F(Server, IsNotNeededByAStore) {
  const std::string store = path("robot.engram");
  const RunResult first = commit(kCup, "{\"height\": 0.25}", "1000", {"--db", store});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out, std::string(kCup) + "/1970-01-01 00:00:00.000001\n");
  write("lines.jsonl", "{\"entity\": \"" + std::string(kCup) +
                           "\", \"time\": 2000, \"data\": {\"height\": 0.5}}\n"
                           "{\"entity\": \"Robot/a/b/c\", \"time\": 1, \"data\": 1}\n");
  for (const char* durability : {"memory", "server"})
    EXPECT_EQ(run_engram({"commit", "--db", store, "--lines", path("lines.jsonl"), "--durability",
                          durability})
                  .out,
              "2 snapshots committed\n");
  const Json all = json_of(run_engram({"query", store, std::string(kCup) + " @ all", "--json"}));
  const Json& snapshots = all.at("entities").at(0).at("snapshots");
  ASSERT_THAT(snapshots, SizeIs(2)) << "of the same time counts once";
  EXPECT_EQ(snapshots[1].at("instances")[0].at("data").at("height"), 0.5);
  EXPECT_EQ(
      run_engram({"commit", kCup, "--data", "1", "--db", store, "--server", at("s")}).exit_code, 2);
  RunningEngram server({"serve", store, "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  const RunResult held = commit(kCup, "{\"height\": 1}", "3000", {"--db", store});
  EXPECT_EQ(held.exit_code, 1);
  EXPECT_THAT(held.err, HasSubstr("robot.engram"));
}

TEST_F(Server, NotesWhoAskedWhat) {
  const std::string log = path("audit.log");
  const std::vector<std::string> serve{"serve", path("robot.engram"), "--no-system-state",
                                       "--audit", log};
  const RunResult none = run_engram(serve);
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("engram audit create"));
  ASSERT_EQ(run_engram({"audit", "create", log}).exit_code, 0);
  EXPECT_EQ(run_engram({"audit", "create", log}).exit_code, 1);
  EXPECT_THAT(run_engram({"audit", "verify", log}).out, HasSubstr("no records yet"));
  {
    RunningEngram server(serve);
    ASSERT_TRUE(server.wait_for("listens at"));
    EXPECT_EQ(commit(kCup, "{\"height\": 1}", "1000").exit_code, 0);
    EXPECT_EQ(run_engram({"query", kCup}).exit_code, 0);
    // It may be verified while it is written, and what is noted survives a kill.
    EXPECT_EQ(json_of(run_engram({"audit", "verify", log, "--json"})).at("lines"), 3);
    EXPECT_EQ(server.end(SIGKILL).exit_code, -SIGKILL);
  }
  const Json report = json_of(run_engram({"audit", "verify", log, "--json"}));
  EXPECT_EQ(report.at("whole_records"), 3);
  EXPECT_TRUE(report.at("flaws").empty());
  std::filesystem::rename(log + ".key", path("elsewhere"));
  EXPECT_EQ(run_engram({"audit", "verify", log}).exit_code, 1);
  std::filesystem::resize_file(log, std::filesystem::file_size(log) - 1);
  const RunResult cut = run_engram({"audit", "verify", log, "--key", path("elsewhere")});
  EXPECT_EQ(cut.exit_code, 3) << cut.err;
  EXPECT_THAT(cut.out, HasSubstr("line 3: record 2 is missing at the end"));
}

/// Programs of the robot find the replay where the robot was.
TEST_F(Server, ReplaysAStoreAsTheMemoryThatItWas) {
  std::string lines;
  for (int i = 0; i < 20; ++i)
    lines += fmt::format("{{\"entity\": \"{}\", \"time\": {}, \"data\": {{\"n\": {}}}}}\n", kCup,
                         1'600'000'000'000'000'000 + i * 1'000'000'000LL, i);
  write("lines.jsonl", lines);
  const std::string store = path("robot.engram");
  ASSERT_EQ(run_engram({"commit", "--db", store, "--lines", path("lines.jsonl")}).exit_code, 0);
  const RunResult early = run_engram({"replay", store, "--at", "2001-01-01"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.err, HasSubstr("lies before the first snapshot at 2020-09-13 12:26:40.000000"));
  EXPECT_EQ(run_engram({"replay", store, "--speed", "0"}).exit_code, 2);
  EXPECT_EQ(run_engram({"replay", store, "--loop", "latest"}).exit_code, 2);
  EXPECT_EQ(run_engram({"replay"}).exit_code, 2);

  // What arrived years after its time counts as imported.
  RunningEngram replay({"replay", store, "--paused"});
  ASSERT_TRUE(replay.wait_for("listens at " + at("engram.sock")));
  const std::string socket = at("engram.sock");
  RunningEngram watch({"watch", "Objects", "--count", "19"});
  ASSERT_TRUE(watch.wait_for("watching"));
  EXPECT_THAT(run_engram({"query", "Objects @ latest"}).out, HasSubstr("{\"n\":0}"));
  const RunResult stepped = run_engram({"replay", "--server", socket, "step"});
  EXPECT_EQ(stepped.exit_code, 0) << stepped.err;
  EXPECT_EQ(run_engram({"replay", "--server", socket, "jump"}).exit_code, 2);
  EXPECT_EQ(run_engram({"replay", "--server", socket, "seek", "2001-01-01"}).exit_code, 1);
  EXPECT_THAT(run_engram({"replay", "--server", socket, "speed", "0"}).err,
              HasSubstr("found a speed of 0, needs one from 0.001 to 1000"));
  // What says how a replay begins would be of no effect on one that runs.
  for (const char* option : {"--at=2020-09-13", "--speed=2", "--paused", "--loop=0..1",
                             "--listen=unix:/tmp/x", "--name=x", "--config=robot.yaml"}) {
    const RunResult refused = run_engram({"replay", "--server", socket, "status", option});
    EXPECT_EQ(refused.exit_code, 2) << option;
    const std::string name = std::string(option).substr(0, std::string(option).find('='));
    EXPECT_THAT(refused.err, HasSubstr("found " + name + " beside --server"));
  }
  while (run_engram({"replay", "--server", socket, "step"}).exit_code == 0) {
  }
  const RunResult watched = watch.end(0);
  EXPECT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_THAT(watched.out, HasSubstr("cup/2020-09-13 12:26:59.000000\n"));
  const Json state = json_of(run_engram({"replay", "--server", socket, "status", "--json"}));
  EXPECT_EQ(state.at("told"), 19);
  EXPECT_EQ(state.at("is_playing"), false);
  const RunResult latest = run_engram({"query", "Objects @ latest"});
  EXPECT_THAT(latest.out, HasSubstr("{\"n\":19}"));
  EXPECT_EQ(replay.end(SIGTERM).exit_code, 0);
}

TEST_F(Server, SaysWhatIsWrongWithArgumentsAndLines) {
  for (const char* command : {"serve", "mns", "commit", "watch"})
    EXPECT_THAT(run_engram({command, "--help"}).out, HasSubstr("Examples:")) << command;
  EXPECT_EQ(run_engram({"serve"}).exit_code, 2);
  EXPECT_EQ(run_engram({"serve", "a", "--config", "robot.yaml"}).exit_code, 2);
  EXPECT_THAT(run_engram({"serve", "a", "--config", "robot.yaml"}).err, HasSubstr("store"));
  EXPECT_EQ(run_engram({"info", "a", "--server", at("s")}).exit_code, 2);
  EXPECT_THAT(run_engram({"info", "--server", at("s")}).err, HasSubstr("no server listens"));
  EXPECT_THAT(run_engram({"query", "Objects", "--server", "unix:s"}).err, HasSubstr("absolute"));
  EXPECT_EQ(run_engram({"commit", kCup, "--server", at("s")}).exit_code, 2);
  write("robot.yaml", "servers: [{store: a, mod: latest}]");
  const RunResult config = run_engram({"serve", "--config", path("robot.yaml")});
  EXPECT_EQ(config.exit_code, 2);
  EXPECT_THAT(config.err, HasSubstr("did you mean 'mode'"));
  const RunResult open = run_engram({"serve", path("s"), "--listen", "0.0.0.0:0"});
  EXPECT_EQ(open.exit_code, 1);
  EXPECT_THAT(open.err, HasSubstr("TLS certificate"));

  RunningEngram server({"serve", path("robot.engram"), "--no-system-state"});
  ASSERT_TRUE(server.wait_for("listens at"));
  write("lines.jsonl", "{\"entity\": \"Objects/a/b/c\", \"data\": 1}\n{\"entity\": \"Objects\"}\n");
  const RunResult lines = run_engram({"commit", "--lines", path("lines.jsonl")});
  EXPECT_EQ(lines.exit_code, 1);
  EXPECT_THAT(lines.err, HasSubstr("line 2 (1 snapshots before it were taken)"));
}

}  // namespace
}  // namespace engram::cli
