// SPDX-License-Identifier: Apache-2.0
#include "server/robot/robot_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Result<RobotConfig> parse(std::string_view text) {
  return parse_robot_config(text, "robot.yaml", "/etc/engram");
}

std::string problem(std::string_view text) {
  const auto config = parse(text);
  EXPECT_EQ(config.status().code(), StatusCode::kInvalidArgument) << text;
  return std::string(config.status().message());
}

TEST(RobotConfig, NeedsNoMoreThanAStore) {
  const auto config = parse("servers: [{store: robot.engram}]");
  ASSERT_TRUE(config.ok()) << config.status().to_string();
  ASSERT_THAT(config->servers, SizeIs(1));
  const MemoryServer::Options& options = config->servers[0].options;
  EXPECT_EQ(options.service.name, "engram");
  EXPECT_THAT(options.service.memories, IsEmpty());
  ASSERT_TRUE(options.service.store);
  EXPECT_EQ(options.service.store->store, "/etc/engram/robot.engram");
  EXPECT_EQ(options.service.memory.mode, ltm::StoreMode::kWhatLeaves);
  EXPECT_EQ(options.durability, memory::MemoryService::Durability::kMemory);
  ASSERT_THAT(options.rpc.endpoints, SizeIs(1));
  EXPECT_THAT(options.rpc.endpoints[0].path(), HasSubstr("/engram.sock"));
  EXPECT_EQ(config->system_state, 0u);
}

TEST(RobotConfig, TakesTheWordOfEarlierVersionsForLatents) {
  for (const char* word : {"latent", "latents"}) {
    const auto config = parse(fmt::format("servers: [{{store: a, prefer: {}}}]", word));
    ASSERT_TRUE(config.ok()) << config.status().to_string();
    EXPECT_TRUE(config->servers[0].options.service.store->prefers_latents) << word;
  }
  const std::string wrong = problem("servers: [{store: a, prefer: raw}]");
  EXPECT_THAT(wrong, HasSubstr("needs one of recorded, latent"));
  EXPECT_THAT(wrong, ::testing::Not(HasSubstr("latents")));
}

TEST(RobotConfig, IsThatOfAStoreWithoutAFile) {
  const auto given = robot_of_store("robot.engram");
  const auto read = parse_robot_config("servers: [{store: robot.engram}]", "robot.yaml", "");
  ASSERT_TRUE(given.ok() && read.ok());
  const MemoryServer::Options& a = given->servers[0].options;
  const MemoryServer::Options& b = read->servers[0].options;
  EXPECT_EQ(a.service.store->store, b.service.store->store);
  EXPECT_EQ(a.rpc.endpoints, b.rpc.endpoints);
  EXPECT_EQ(a.service.name, b.service.name);
  EXPECT_EQ(given->system_state, read->system_state);
  EXPECT_EQ(given->servers[0].min_bytes, read->servers[0].min_bytes);
}

TEST(RobotConfig, ReadsEveryKey) {
  const ScratchDirectory folder;
  const std::string recording = "preset: balanced\n";
  overwrite_file(folder / "recording.yaml", std::as_bytes(std::span(recording)));
  const auto config = parse_robot_config(R"(
security: {certificate: server.pem, key: server.key, client_ca: clients.pem, tokens: tokens.yaml}
names: {at: 'names.local:50050', token: mine.token, ca: ca.pem}
system_state: vision
servers:
  - name: vision
    memories: [Vision]
    listen: ['unix:/run/engram/vision.sock', '0.0.0.0:50051']
    reached_at: 'head.local:50051'
    store: vision.engram
    recording: recording.yaml
    mode: everything
    durability: journal
    working_memory: {bytes: 1GiB, snapshots: 1000, age: 10min, min_bytes: 64MiB, waiting: 128MiB,
                     read_half_life: 5min}
    segments:
      - {match: Vision/RGB, snapshots: 300, bytes: 256MiB, age: 1min}
    decoded: 32MiB
    prefer: latent
    prior: prior
    max_horizon: 5s
    max_entities: 5000
    threads: 3
  - name: scratch
    memories: [Scratch]
    listen: 'unix:/run/engram/scratch.sock'
    latest_every: 5s
)",
                                         "robot.yaml", folder.path());
  ASSERT_TRUE(config.ok()) << config.status().to_string();
  EXPECT_EQ(config->names->at->to_string(), "names.local:50050");
  EXPECT_EQ(config->names->token, folder / "mine.token");
  EXPECT_EQ(config->security.client_ca, folder / "clients.pem");
  EXPECT_EQ(config->system_state, 0u);
  const ServerConfig& vision = config->servers[0];
  EXPECT_EQ(vision.prior, folder / "prior");
  EXPECT_EQ(vision.min_bytes, uint64_t{64} << 20);
  EXPECT_EQ(vision.options.tokens, folder / "tokens.yaml");
  EXPECT_EQ(vision.options.rpc.security.key, folder / "server.key");
  EXPECT_EQ(vision.options.rpc.endpoints[1].to_string(), "0.0.0.0:50051");
  EXPECT_EQ(vision.options.reached_at[0].to_string(), "head.local:50051");
  EXPECT_EQ(vision.options.durability, memory::MemoryService::Durability::kJournal);
  EXPECT_EQ(vision.options.threads, 3);
  const memory::MemoryService::Options& service = vision.options.service;
  EXPECT_THAT(service.memories, ElementsAre("Vision", "SystemState"));
  EXPECT_EQ(service.max_horizon, std::chrono::seconds(5));
  EXPECT_EQ(service.max_entities, 5000U);
  EXPECT_TRUE(service.store->prefers_latents);
  EXPECT_EQ(service.store->max_decoded_bytes, size_t{32} << 20);
  EXPECT_THAT(service.store->recording.rules, SizeIs(2));  // Those of the preset.
  const ltm::WorkingMemory::Options& memory = service.memory;
  EXPECT_EQ(memory.mode, ltm::StoreMode::kEverything);
  EXPECT_EQ(memory.all.bytes, size_t{1} << 30);
  EXPECT_EQ(memory.all.snapshots, 1000u);
  EXPECT_EQ(memory.all.age, std::chrono::minutes(10));
  EXPECT_EQ(memory.max_waiting_bytes, size_t{128} << 20);
  EXPECT_EQ(memory.read_half_life, std::chrono::minutes(5));
  ASSERT_THAT(memory.segments, SizeIs(1));
  EXPECT_EQ(memory.segments[0].segment.to_string(), "Vision/RGB");
  EXPECT_EQ(memory.segments[0].limits.snapshots, 300u);
  const memory::MemoryService::Options& scratch = config->servers[1].options.service;
  EXPECT_FALSE(scratch.store);
  EXPECT_EQ(scratch.memory.mode, ltm::StoreMode::kLatest);
  EXPECT_EQ(scratch.memory.store_interval, std::chrono::seconds(5));
}

TEST(RobotConfig, ReadsWhatIsSensory) {
  const auto config = parse(R"(
servers:
  - store: a
    segments:
      - {match: Vision/RGB, sensory: 500ms}
      - {match: Vision/Depth/head, sensory: 2s, snapshots: 10}
      - {match: Hand, snapshots: 5}
    sensory_memory: {ring: 128MiB, queries_attend: 3s}
)");
  ASSERT_TRUE(config.ok()) << config.status().to_string();
  const memory::MemoryService::Options& service = config->servers[0].options.service;
  ASSERT_THAT(service.sensory.segments, SizeIs(2));
  EXPECT_EQ(service.sensory.segments[0].match.to_string(), "Vision/RGB");
  EXPECT_EQ(service.sensory.segments[0].hold, std::chrono::milliseconds(500));
  EXPECT_EQ(service.sensory.segments[1].hold, std::chrono::seconds(2));
  EXPECT_EQ(service.sensory.ring_bytes, size_t{128} << 20);
  EXPECT_EQ(service.sensory.query_attention, std::chrono::seconds(3));
  EXPECT_THAT(service.memory.segments, SizeIs(2));
}

TEST(RobotConfig, NamesWhatIsWrongWithWhatIsSensory) {
  const auto of = [](const std::string& segments, const std::string& more = "") {
    return problem("servers:\n  - store: a\n    segments: [" + segments + "]\n" + more);
  };
  EXPECT_THAT(of("{match: Vision, sensory: 11s}"),
              HasSubstr("robot.yaml:3: 'servers[0].segments[0].sensory': sensory: found 11s for "
                        "'Vision', needs 1ms to 10s"));
  EXPECT_THAT(of("{match: Vision, sensory: 100us}"), HasSubstr("needs 1ms to 10s"));
  EXPECT_THAT(of("{match: Vision, sensory: soon}"), HasSubstr("soon"));
  EXPECT_THAT(of("{match: Vision, sensory: 1s}, {match: Vision, sensory: 2s}"),
              HasSubstr("found 'Vision' twice"));
  EXPECT_THAT(of("{match: Vision, sensry: 1s}"), HasSubstr("did you mean 'sensory'?"));
  EXPECT_THAT(of("{match: Vision, sensory: 1s}", "    sensory_memory: {ring: 1KiB}"),
              HasSubstr("found a ring of 1024 bytes"));
  EXPECT_THAT(of("{match: Vision, sensory: 1s}", "    sensory_memory: {queries_attend: 2min}"),
              HasSubstr("attend for 2min"));
  EXPECT_THAT(of("{match: Vision, snapshots: 1}", "    sensory_memory: {ring: 1MiB}"),
              HasSubstr("needs an entry of 'segments' that is sensory"));
}

TEST(RobotConfig, TakesOldNamesOfKeysWithAWarning) {
  ::testing::internal::CaptureStderr();
  const auto config = parse(
      "servers: [{store: a, working_memory: {bytes: 8MiB, least: 2MiB}, furthest_prediction: 9s}]");
  const std::string told = ::testing::internal::GetCapturedStderr();
  ASSERT_TRUE(config.ok()) << config.status().to_string();
  EXPECT_EQ(config->servers[0].min_bytes, uint64_t{2} << 20);
  EXPECT_EQ(config->servers[0].options.service.max_horizon, std::chrono::seconds(9));
  for (const char* word : {"working_memory.least", "'min_bytes'", "servers[0].furthest_prediction",
                           "'max_horizon'", "version 0.3"})
    EXPECT_THAT(told, HasSubstr(word));
}

TEST(RobotConfig, NamesFileLineAndKeyOfWhatIsWrong) {
  EXPECT_THAT(problem("servers:\n  - {store: a, mod: latest}"),
              HasSubstr("robot.yaml:2: 'servers[0].mod': unknown key; did you mean 'mode'?"));
  EXPECT_THAT(problem("servers:\n  - {store: a, mode: newest}"), HasSubstr("what-leaves"));
  EXPECT_THAT(problem("servers: [{listen: 'unix:relative'}]"), HasSubstr("absolute path"));
  EXPECT_THAT(problem("servers: [{store: a, working_memory: {bytes: 0B}}]"), HasSubstr("0 bytes"));
  EXPECT_THAT(problem("servers: [{store: a, working_memory: {bytes: 1MiB, min_bytes: 2MiB}}]"),
              HasSubstr("'servers[0].working_memory.min_bytes'"));
  EXPECT_THAT(problem("servers: [{store: a, working_memory: {snapshots: -1}}]"),
              HasSubstr("at least 1"));
  EXPECT_THAT(problem("servers: [{store: a, segments: [{match: Vision}]}]"), HasSubstr("no limit"));
  EXPECT_THAT(problem("servers: [{store: a, threads: 0}]"), HasSubstr("1 to 64"));
  EXPECT_THAT(problem("servers: [{store: a, memories: []}]"), HasSubstr("empty list"));
  EXPECT_THAT(problem("servers: [{store: a, preset: tiny}]"), HasSubstr("balanced"));
  EXPECT_THAT(problem("servers: [{store: a, preset: small, recording: b.yaml}]"),
              HasSubstr("one of them"));
  EXPECT_THAT(problem("servers: [{store: a, recording: none.yaml}]"), HasSubstr("none.yaml"));
  EXPECT_THAT(problem("servers: [{name: a/b, store: a}]"), HasSubstr("'listen'"));
}

TEST(RobotConfig, RefusesWhatNeedsAStoreWithoutOne) {
  EXPECT_THAT(problem("servers: [{mode: everything}]"), HasSubstr("'store'"));
  EXPECT_THAT(problem("servers: [{durability: journal}]"), HasSubstr("'store'"));
  EXPECT_THAT(problem("servers: [{preset: small}]"), HasSubstr("'store'"));
}

TEST(RobotConfig, RefusesServersThatCannotBeToldApart) {
  EXPECT_THAT(problem("servers: [{store: a}, {store: b}]"), HasSubstr("'name'"));
  EXPECT_THAT(problem("servers: [{name: a, store: a}, {name: a, store: b}]"),
              HasSubstr("a server 'a' already"));
  EXPECT_THAT(problem("servers: [{name: a, memories: [Vision]}, {name: b, memories: [Vision]}]"),
              HasSubstr("memory 'Vision' is that of server 'a'"));
}

TEST(RobotConfig, TellsTheNameSystemWhatItNeeds) {
  EXPECT_THAT(problem("names: {listen: 'unix:/n', at: 'unix:/m'}"), HasSubstr("either 'listen'"));
  EXPECT_THAT(problem("names: {}\nservers: [{store: a}]"), HasSubstr("either 'listen'"));
  EXPECT_THAT(problem("names: {listen: 'unix:/n'}\nservers: [{store: a}]"),
              HasSubstr("'memories'"));
  EXPECT_THAT(problem("names: {listen: 'unix:/n'}\n"
                      "servers: [{memories: [A], listen: '0.0.0.0:1'}]"),
              HasSubstr("'reached_at'"));
  EXPECT_THAT(problem("names: {listen: 'unix:/n', token: t}"), HasSubstr("elsewhere"));
  EXPECT_THAT(problem(""), HasSubstr("neither"));
  EXPECT_TRUE(parse("names: {listen: 'unix:/n'}").ok());
}

TEST(RobotConfig, GivesTheStateOfTheSystemToOneServer) {
  const auto holder = [](std::string_view text) {
    const auto config = parse(text);
    EXPECT_TRUE(config.ok()) << config.status().to_string();
    return config.ok() ? config->system_state : std::nullopt;
  };
  EXPECT_EQ(holder("servers: [{name: a, memories: [A]}, {name: b, memories: [B, SystemState]}]"),
            1);
  EXPECT_EQ(holder("servers: [{name: a, memories: [A]}, {name: b}]"), 1);
  EXPECT_EQ(holder("servers: [{name: a, memories: [A]}, {name: b, memories: [B]}]"), 0);
  EXPECT_EQ(holder("system_state: b\nservers: [{name: a}, {name: b}]"), 1);
  EXPECT_EQ(holder("system_state: false\nservers: [{name: a}]"), std::nullopt);
  // Another process may have it already.
  EXPECT_EQ(holder("names: {at: 'unix:/n'}\nservers: [{memories: [A]}]"), std::nullopt);
  EXPECT_EQ(holder("system_state: true\nnames: {at: 'unix:/n'}\nservers: [{memories: [A]}]"), 0);
  EXPECT_THAT(problem("system_state: c\nservers: [{name: a}]"), HasSubstr("name of a server"));
}

}  // namespace
}  // namespace engram::server
