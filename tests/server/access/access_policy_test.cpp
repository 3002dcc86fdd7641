// SPDX-License-Identifier: Apache-2.0
#include "server/access/access_policy.h"

#include <sys/stat.h>

#include <atomic>
#include <optional>
#include <thread>

#include "ltm/core/file.h"
#include "ltm/memory/score_id.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"

namespace engram::server {
namespace {

using engram::testing::write_secret;
using ltm::MemoryId;
using std::chrono::seconds;

constexpr SteadyTime kStart{seconds(100)};

MemoryId id(std::string_view text) {
  return *MemoryId::parse(text);
}

std::string entry(std::string_view name, std::string_view token, std::string_view rest) {
  return fmt::format("  - name: {}\n    token_sha256: {}\n    {}\n", name,
                     to_hex(hash_token(token)), rest);
}

Result<AccessPolicy> parse(const std::string& text, const std::filesystem::path& directory = {}) {
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue config, ConfigValue::parse(text, "tokens.yaml"));
  return AccessPolicy::parse(config, directory, kStart);
}

std::string rules(std::string_view role, std::string_view memories) {
  return fmt::format("role: {}\n    memories: {}", role, memories);
}

TEST(AccessPolicy, KnowsWhoHasAToken) {
  const auto policy = parse("tokens:\n" + entry("viewer", "token-v", rules("read", "all")) +
                            entry("robot", "token-r", rules("write", "[Robot]")));
  ASSERT_OK(policy);
  EXPECT_EQ(policy->authenticate("token-r")->name(), "robot");
  EXPECT_OK(policy->authenticate("token-r")->check(Right::kWrite, id("Robot/Arm")));
  EXPECT_EQ(policy->authenticate("token-v")->name(), "viewer");
}

TEST(AccessPolicy, RefusesAnyOtherTokenWithoutRepeatingIt) {
  const auto policy = parse("tokens:\n" + entry("viewer", "token-v", rules("read", "all")));
  for (const std::string& token :
       std::vector<std::string>{"token-", "token-vv", "Token-v", to_hex(hash_token("token-v")),
                                std::string(5000, 'x'), std::string("token-v\0", 8)}) {
    const auto identity = policy->authenticate(token);
    EXPECT_EQ(identity.status().code(), StatusCode::kFailedPrecondition);
    EXPECT_THAT(identity.status().message(), ::testing::Not(::testing::HasSubstr(token)));
  }
  EXPECT_FAILS(policy->authenticate(""), StatusCode::kFailedPrecondition, "no token");
}

TEST(AccessPolicy, GivesRolesWhatTheyMayAndNothingMore) {
  const auto policy =
      parse("tokens:\n" + entry("r", "r", rules("read", "all")) +
            entry("w", "w", rules("write", "all")) + entry("a", "a", rules("admin", "all")));
  for (const std::string token : {"r", "w", "a"}) {
    const auto holder = policy->authenticate(token);
    EXPECT_OK(holder->check(Right::kRead, id("Vision")));
    EXPECT_OK(holder->check(Right::kModels, id("Vision")));
    EXPECT_EQ(holder->check(Right::kWrite, id("Vision")).ok(), token != "r");
    EXPECT_TRUE(holder->may_read_all(id("")));
    EXPECT_EQ(holder->view(), nullptr);
  }
  EXPECT_FAILS(policy->authenticate("r")->check(Right::kWrite, id("")),
               StatusCode::kFailedPrecondition, "'r' may not write all memories");
}

TEST(AccessPolicy, KeepsToTheMemoriesThatAreNamed) {
  const auto policy = parse(
      "tokens:\n" + entry("v", "v", rules("write", "[Vision/RGB, 'Robot/Arm\\/left/imu/x']")));
  ASSERT_OK(policy);
  const Identity identity = *policy->authenticate("v");
  EXPECT_OK(identity.check(Right::kWrite, id("Vision/RGB/head/cam")));
  EXPECT_OK(identity.check(Right::kRead, id("Vision/RGB")));
  const auto view = identity.view();
  ASSERT_NE(view, nullptr);
  EXPECT_TRUE(view->of(id("Vision/RGB/head/cam").at(time_from_ns(5)).instance(0)).is_all());
  EXPECT_TRUE(view->of(id("Robot/Arm\\/left/imu/x")).is_all());
  for (const char* other : {"", "Vision", "Vision/RGBD", "Vision/RGBD/head/cam", "Robot", "Grasp",
                            "Robot/Arm/left/imu"}) {
    EXPECT_TRUE(view->of(id(other)).times.empty()) << other;
    EXPECT_FALSE(view->of(id(other)).predictions) << other;
    for (const Right right : {Right::kRead, Right::kModels, Right::kWrite})
      EXPECT_FALSE(identity.check(right, id(other)).ok()) << other;
  }
  EXPECT_FAILS(identity.check(Right::kRead, id("Vision")), StatusCode::kFailedPrecondition,
               "'v' may not read 'Vision'");
}

std::string grants(std::string_view list) {
  return fmt::format("grants: [{}]", list);
}

TEST(AccessPolicy, GivesEachGrantItsOwnRightsAndTimes) {
  const auto policy =
      parse("tokens:\n" +
            entry("v", "v",
                  grants("{ids: [Vision], may: [read], from: '1970-01-01T00:00:10Z', until: "
                         "'1970-01-01T00:00:20Z'}, {ids: [Vision/RGB], may: [read, write], from: "
                         "'1970-01-01T00:00:30Z'}, {ids: [Robot], may: [read, models]}")));
  ASSERT_OK(policy);
  const Identity identity = *policy->authenticate("v");
  const auto at = [](int64_t s) { return time_from_ns(s * 1'000'000'000); };
  const auto reads = [&](const char* entity, int64_t s) {
    const bool may = identity.check(Right::kRead, id(entity), at(s)).ok();
    EXPECT_EQ(identity.view()->of(id(entity)).times.contains(at(s)), may);
    return may;
  };
  for (const auto& [s, depth, rgb] :
       std::vector<std::tuple<int64_t, bool, bool>>{{9, false, false},
                                                    {10, true, true},
                                                    {20, true, true},
                                                    {21, false, false},
                                                    {29, false, false},
                                                    {30, false, true},
                                                    {99, false, true}}) {
    EXPECT_EQ(reads("Vision/Depth/head/cam", s), depth) << s;
    EXPECT_EQ(reads("Vision/RGB/head/cam", s), rgb) << s;
    EXPECT_TRUE(reads("Robot/Arm/left/imu", s)) << s;
    EXPECT_EQ(identity.check(Right::kWrite, id("Vision/RGB/head/cam"), at(s)).ok(), s >= 30) << s;
    EXPECT_FALSE(identity.check(Right::kWrite, id("Vision/Depth/head/cam"), at(s)).ok()) << s;
  }
  EXPECT_FAILS(identity.check(Right::kRead, id("Vision/Depth/head/cam"), at(21)),
               StatusCode::kFailedPrecondition,
               "'v' may not read 'Vision/Depth/head/cam' at 1970-01-01 00:00:21");
  EXPECT_OK(identity.check(Right::kModels, id("Robot/Arm/left/imu")));
  EXPECT_FALSE(identity.check(Right::kModels, id("Vision/RGB/head/cam")).ok());
  EXPECT_FALSE(identity.may_read_all(id("Vision")));
  EXPECT_FALSE(identity.may_read_all(id("Vision/RGB")));
  EXPECT_TRUE(identity.may_read_all(id("Robot")));
}

TEST(AccessPolicy, LetsAWindowMoveWithTheClock) {
  const auto policy =
      parse("tokens:\n" + entry("v", "v", grants("{ids: all, may: [read], last: 1h}")));
  ASSERT_OK(policy);
  const Identity identity = *policy->authenticate("v");
  const auto minutes = [](int64_t n) { return std::chrono::minutes(n); };
  EXPECT_OK(identity.check(Right::kRead, id("Vision"), system_now() - minutes(59)));
  EXPECT_FALSE(identity.check(Right::kRead, id("Vision"), system_now() - minutes(61)).ok());
  EXPECT_OK(identity.check(Right::kRead, id("Vision"), system_now() + minutes(5)));
}

TEST(AccessPolicy, GivesImagesRedactedWhereNoOtherGrantGivesThemAsTheyAre) {
  const std::string redact = "redact: {detector: people}\n";
  const std::string some =
      "{ids: all, may: [read], form: redacted}, {ids: [Hall], may: [read], form: exact}, "
      "{ids: [Bath], may: [read], until: '1970-01-01T00:00:10Z'}";
  const auto policy = parse(redact + "tokens:\n" + entry("v", "v", grants(some)) +
                            entry("w", "w", rules("read", "[Bath]")));
  ASSERT_OK(policy);
  EXPECT_TRUE(policy->redaction().has_value());
  const Identity identity = *policy->authenticate("v");
  const auto sees = [&](const char* entity, int64_t s) {
    const ltm::Sight sight = identity.view()->of(id(entity));
    EXPECT_TRUE(sight.times.is_all());
    return sight.exact.contains(time_from_ns(s * 1'000'000'000));
  };
  EXPECT_TRUE(sees("Hall/a/b/c", 99));
  EXPECT_FALSE(sees("Bed/a/b/c", 99));
  EXPECT_TRUE(sees("Bath/a/b/c", 10));
  EXPECT_FALSE(sees("Bath/a/b/c", 11));
  EXPECT_TRUE(identity.may_read_all(id("Hall")));
  EXPECT_FALSE(identity.may_read_all(id("Bath")));
  EXPECT_FALSE(identity.may_read_all(id("")));
  EXPECT_TRUE(policy->authenticate("w")->may_read_all(id("Bath")));
  const auto refuses = [](const std::string& text, const std::string& why) {
    EXPECT_FAILS(parse(text), StatusCode::kInvalidArgument, why);
  };
  refuses("tokens:\n" + entry("v", "v", grants(some)), "needs 'redact' in this file");
  refuses(redact + "tokens:\n" + entry("v", "v", grants("{ids: all, may: [read], form: blurred}")),
          "needs exact or redacted");
  for (const char* other : {"[read, models]", "[read, write]", "[write]"})
    refuses(
        redact + "tokens:\n" +
            entry("v", "v", grants(fmt::format("{{ids: all, may: {}, form: redacted}}", other))),
        "needs a grant of its own");
  refuses("redact: {detector: ghosts}\ntokens:\n" + entry("v", "v", rules("read", "all")),
          "ghosts");
}

TEST(AccessPolicy, ShowsScoresOfPredictionsToWhoSeesTheirEntity) {
  const auto policy =
      parse("tokens:\n" + entry("all", "a", rules("read", "[SystemState, Robot]")) +
            entry("some", "s",
                  grants("{ids: [SystemState, Vision], may: [read, models]}, {ids: [Robot/Arm], "
                         "may: [read], until: '1970-01-01T00:00:10Z'}, {ids: [Robot/Leg], "
                         "may: [read]}")));
  ASSERT_OK(policy);
  const auto sees = [&](const char* token, const ltm::MemoryId& entity) {
    return !policy->authenticate(token)->view()->of(entity).times.empty();
  };
  for (const auto& [entity, some] : std::vector<std::pair<const char*, bool>>{
           {"Vision/RGB/head/cam", true}, {"Robot/Arm/l/imu", false}, {"Robot/Leg/l/imu", false}}) {
    const ltm::MemoryId score = ltm::score_id(id(entity));
    EXPECT_EQ(ltm::scored_entity(score), id(entity));
    EXPECT_EQ(sees("s", score), some) << entity;
    EXPECT_EQ(sees("a", score), !some) << entity;
  }
  // Scores of scores are no way around it.
  EXPECT_FALSE(sees("s", ltm::score_id(ltm::score_id(id("Robot/Leg/l/imu")))));
  EXPECT_TRUE(sees("s", id("SystemState/Replay/engram/clock")));
  EXPECT_EQ(ltm::scored_entity(id("SystemState/Replay/engram/clock")), std::nullopt);
}

TEST(AccessPolicy, GivesTheRightToEraseToAdminsAndByGrantsOnly) {
  const auto policy =
      parse("tokens:\n" + entry("a", "a", rules("admin", "all")) +
            entry("w", "w", rules("write", "all")) + entry("r", "r", rules("read", "all")) +
            entry("g", "g",
                  grants("{ids: [Hall/a], may: [erase], from: '1970-01-01T00:00:10Z', until: "
                         "'1970-01-01T00:00:20Z'}, {ids: [Hall], may: [read]}")));
  ASSERT_OK(policy);
  EXPECT_OK(policy->authenticate("a")->check(Right::kErase, id("Hall")));
  EXPECT_EQ(policy->authenticate("a")->erasable(), nullptr) << "everything";
  for (const char* token : {"w", "r"}) {
    const auto holder = policy->authenticate(token);
    EXPECT_FAILS(holder->check(Right::kErase, id("Hall")), StatusCode::kFailedPrecondition,
                 "may not erase 'Hall'");
    EXPECT_FAILS(holder->check_below(Right::kErase, id("")), StatusCode::kFailedPrecondition,
                 "may erase nothing");
    EXPECT_TRUE(holder->erasable()->of(id("Hall/a/b/c")).times.empty());
  }
  const Identity identity = *policy->authenticate("g");
  EXPECT_OK(identity.check_below(Right::kErase, id("")));
  EXPECT_OK(identity.check_below(Right::kErase, id("Hall")));
  EXPECT_FALSE(identity.check(Right::kErase, id("Hall")).ok());
  EXPECT_FALSE(identity.check_below(Right::kErase, id("Hall/b")).ok());
  const auto times = identity.erasable()->of(id("Hall/a/b/c")).times;
  EXPECT_TRUE(times.contains(time_from_ns(15'000'000'000)));
  EXPECT_FALSE(times.contains(time_from_ns(21'000'000'000)));
  EXPECT_TRUE(identity.erasable()->of(id("Hall/b/b/c")).times.empty());
  EXPECT_FALSE(identity.erasable()->of(id("Hall/a/b/c")).predictions);
}

TEST(AccessPolicy, RefusesGrantsThatContradictThemselves) {
  const auto refuses = [](const std::string& rest, const std::string& why) {
    EXPECT_FAILS(parse("tokens:\n" + entry("x", "x", rest)), StatusCode::kInvalidArgument, why);
  };
  refuses("grants: []", "found 0 grants");
  refuses(grants("{ids: all}"), "no key 'may'");
  refuses(grants("{may: [read]}"), "no key 'ids'");
  refuses(grants("{ids: all, may: []}"), "empty list");
  refuses(grants("{ids: all, may: [forget]}"),
          "found 'forget', needs read, models, write or erase");
  refuses(grants("{ids: [], may: [read]}"), "empty list");
  refuses(grants("{ids: all, may: [models]}"), "models without read");
  refuses(grants("{ids: all, may: [read, models], last: 1h}"), "models beside");
  refuses(grants("{ids: all, may: [read, models], until: '2026-01-01T00:00:00Z'}"),
          "models beside");
  refuses(grants("{ids: all, may: [read], last: 1h, from: '2026-01-01T00:00:00Z'}"),
          "needs to stand alone");
  refuses(grants("{ids: all, may: [read], from: '2026-01-02T00:00:00Z', until: "
                 "'2026-01-01T00:00:00Z'}"),
          "needs it after");
  refuses(grants("{ids: all, may: [read], from: soon}"), "soon");
  refuses(grants("{ids: all, may: [read], for: 1h}"), "for");
  refuses(grants("{ids: all, may: [read]}") + "\n    role: read", "stands beside 'grants'");
  refuses(grants("{ids: all, may: [read]}") + "\n    memories: all", "stands beside 'grants'");
}

TEST(AccessPolicy, LimitsHowOftenATokenIsUsed) {
  const auto policy = parse("tokens:\n" + entry("v", "v", rules("read", "all")) +
                            "    rate: 2Hz\n" + entry("w", "w", rules("read", "all")));
  ASSERT_OK(policy);
  const auto first = *policy->authenticate("v");
  const auto second = *policy->authenticate("v");
  EXPECT_OK(first.take_request(kStart));
  EXPECT_OK(second.take_request(kStart));
  EXPECT_FAILS(first.take_request(kStart), StatusCode::kResourceExhausted, "'v'");
  EXPECT_OK(first.take_request(kStart + seconds(1)));
  for (int i = 0; i < 1000; ++i) EXPECT_OK(policy->authenticate("w")->take_request(kStart));
}

TEST(AccessPolicy, TakesNoTokenThatHasExpired) {
  const auto at = [](Time time) {
    return rules("admin", "all") + "\n    expires: '" + engram::to_string(time) + "'";
  };
  const auto policy =
      parse("tokens:\n" + entry("guest", "token-g", at(system_now() - seconds(1))) +
            entry("visitor", "token-v", at(system_now() + std::chrono::milliseconds(300))));
  ASSERT_OK(policy);
  EXPECT_FAILS(policy->authenticate("token-g"), StatusCode::kFailedPrecondition,
               "token of 'guest' expired at");
  // One that expires while its holder is connected is of no use from then on.
  const auto visitor = policy->authenticate("token-v");
  ASSERT_OK(visitor);
  EXPECT_OK(visitor->check(Right::kWrite, id("Vision")));
  EXPECT_OK(visitor->take_request(kStart));
  const auto view = visitor->view();
  ASSERT_NE(view, nullptr);
  EXPECT_TRUE(view->of(id("Vision")).is_all());
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_FAILS(visitor->check(Right::kRead, id("Vision")), StatusCode::kFailedPrecondition,
               "expired");
  EXPECT_FAILS(visitor->take_request(kStart), StatusCode::kFailedPrecondition, "expired");
  EXPECT_FALSE(visitor->may_read_all(id("Vision")));
  EXPECT_TRUE(view->of(id("Vision")).times.empty());
  EXPECT_FALSE(view->of(id("Vision")).predictions);
  EXPECT_FAILS(
      parse("tokens:\n" + entry("a", "token-a", rules("read", "all") + "\n    expires: soon")),
      StatusCode::kInvalidArgument, "soon");
}

TEST(AccessPolicy, LetsEverybodyInWhereThereIsNoTokensFile) {
  const auto policy = AccessPolicy::everyone();
  for (const char* token : {"", "anything"}) {
    const auto identity = policy.authenticate(token);
    ASSERT_OK(identity);
    for (const Right right : {Right::kRead, Right::kModels, Right::kWrite})
      EXPECT_OK(identity->check(right, id("")));
    EXPECT_EQ(identity->view(), nullptr);
    EXPECT_OK(identity->take_request(kStart));
  }
}

TEST(AccessPolicy, OutlivesWithItsIdentitiesThePolicyItself) {
  std::optional<Identity> identity;
  {
    const auto policy = parse("tokens:\n" + entry("v", "v", rules("read", "all")));
    identity = *policy->authenticate("v");
  }
  EXPECT_EQ(identity->name(), "v");
}

TEST(AccessPolicy, RefusesFilesThatSaySomethingElse) {
  const auto refuses = [](const std::string& text, const std::string& why) {
    EXPECT_FAILS(parse(text), StatusCode::kInvalidArgument, why);
  };
  const std::string hash = to_hex(hash_token("x"));
  const std::string fine = entry("x", "x", rules("read", "all"));
  refuses("", "has no key 'tokens'");
  refuses("tokens: []", "found 0 tokens");
  refuses("tokens: x", "needs a list");
  refuses("tokens:\n" + fine + "token: x", "did you mean 'tokens'");
  refuses("tokens:\n" + fine + "    memorys: x", "did you mean 'memories'");
  refuses("tokens:\n" + fine + fine, "name 'x' is there twice");
  refuses("tokens:\n" + fine + entry("y", "x", rules("read", "all")), "has the token of 'x'");
  refuses("tokens:\n  - {role: read}", "no key 'name'");
  refuses("tokens:\n  - {name: x, role: read, memories: all}", "either");
  refuses("tokens:\n  - {name: x, token_sha256: " + hash + ", token_file: y}", "either");
  refuses("tokens:\n  - {name: '', token_sha256: " + hash + "}", "is empty");
  refuses("tokens:\n" + entry("x", "x", rules("reader", "all")), "tokens.yaml:4: ");
  refuses("tokens:\n" + entry("x", "x", rules("read", "[]")), "empty list");
  refuses("tokens:\n" + entry("x", "x", rules("read", "Vision")), "needs a list of IDs, or 'all'");
  refuses("tokens:\n" + entry("x", "x", rules("read", "['']")), "needs a memory");
  refuses("tokens:\n" + entry("x", "x", rules("read", "[a/b/c/d/5]")), "needs a memory");
  refuses("tokens:\n" + entry("x", "x", rules("read", "[a//b]")), "is empty");
  refuses("tokens:\n" + entry("x", "x", rules("read", "all")) + "    rate: 0Hz", "rate");
  refuses("tokens:\n" + entry("x", "x", rules("read", "all")) + "    rate: 5", "rate");
}

TEST(AccessPolicy, NeverRepeatsATokenThatStandsWhereItsHashShould) {
  const auto policy = parse("tokens:\n  - {name: x, token_sha256: my-secret, role: read}");
  EXPECT_FAILS(policy, StatusCode::kInvalidArgument, "64 hexadecimal digits");
  EXPECT_THAT(policy.status().message(), ::testing::Not(::testing::HasSubstr("my-secret")));
}

TEST(AccessPolicy, ReadsTokensFromFilesOfTheirOwn) {
  const ScratchDirectory scratch;
  const std::string token = *make_token();
  const std::string text = "tokens:\n  - {name: x, token_file: x.token, role: read, memories: all}";
  write_secret(scratch / "x.token", token + "\n");
  const auto policy = parse(text, scratch.path());
  ASSERT_OK(policy);
  EXPECT_OK(policy->authenticate(token));
  write_secret(scratch / "x.token", token, 0644);
  EXPECT_FAILS(parse(text, scratch.path()), StatusCode::kFailedPrecondition, "chmod 600");
  write_secret(scratch / "x.token", "guess-me");
  EXPECT_FAILS(parse(text, scratch.path()), StatusCode::kInvalidArgument,
               "8 bytes, needs at least");
  std::filesystem::remove(scratch / "x.token");
  EXPECT_FAILS(parse(text, scratch.path()), StatusCode::kNotFound, "tokens.yaml:2");
}

TEST(AccessPolicy, ReadsOnlyFilesThatOthersCannotRead) {
  const ScratchDirectory scratch;
  const std::string text = "tokens:\n" + entry("v", "v", rules("read", "all"));
  for (const unsigned permissions : {0600u, 0400u, 0640u})
    EXPECT_OK(AccessPolicy::read_file(write_secret(scratch / "t", text, permissions)));
  for (const unsigned permissions : {0644u, 0604u, 0660u, 0666u, 0602u, 0601u})
    EXPECT_FAILS(AccessPolicy::read_file(write_secret(scratch / "t", text, permissions)),
                 StatusCode::kFailedPrecondition, fmt::format("{:04o}", permissions));
}

TEST(AccessPolicy, ReadsNothingButPlainFiles) {
  const ScratchDirectory scratch;
  EXPECT_FAILS(AccessPolicy::read_file(scratch / "none"), StatusCode::kNotFound, "none");
  EXPECT_FAILS(AccessPolicy::read_file(scratch.path()), StatusCode::kFailedPrecondition,
               "no plain");
  ASSERT_EQ(::mkfifo((scratch / "pipe").c_str(), 0600), 0);
  EXPECT_FAILS(AccessPolicy::read_file(scratch / "pipe"), StatusCode::kFailedPrecondition,
               "no plain file");
  write_secret(scratch / "large", std::string(ConfigValue::kMaxBytes + 1, '#'));
  EXPECT_FAILS(AccessPolicy::read_file(scratch / "large"), StatusCode::kInvalidArgument, "bytes");
}

TEST(AccessPolicy, ReadsTheExampleOfTheDocumentation) {
  const auto page = read_file(std::filesystem::path(ENGRAM_SOURCE_DIR) / "docs/access.md");
  ASSERT_OK(page);
  const std::string text(as_text(page->bytes()));
  const std::string start = "```yaml\n";
  const size_t at = text.find(start) + start.size();
  const ScratchDirectory scratch;
  const std::string token = *make_token();
  write_secret(scratch / "maintenance.token", token);
  const auto policy = parse(text.substr(at, text.find("```", at) - at), scratch.path());
  ASSERT_OK(policy);
  EXPECT_EQ(policy->authenticate("example")->name(), "kitchen-robot");
  EXPECT_OK(policy->authenticate(token)->check(Right::kWrite, id("")));
}

TEST(AccessPolicy, AnswersManyThreadsAtOnce) {
  const auto policy =
      parse("tokens:\n" + entry("v", "v", rules("read", "[Vision]")) + "    rate: 1000Hz\n");
  std::atomic<int> taken{0};
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 4; ++thread)
      threads.emplace_back([&] {
        for (int i = 0; i < 500; ++i) {
          const auto identity = policy->authenticate("v");
          EXPECT_OK(identity->check(Right::kRead, id("Vision/RGB")));
          if (identity->take_request(kStart).ok()) ++taken;
        }
      });
  }
  EXPECT_EQ(taken, 1000);
}

}  // namespace
}  // namespace engram::server
