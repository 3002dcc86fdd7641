// SPDX-License-Identifier: Apache-2.0
#include "server/access/audit_log.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "ltm/core/file.h"
#include "server/access/audit_chain.h"
#include "server/access/audit_check.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"

namespace engram::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

AuditEvent event(const std::string& on, const std::string& refused = "") {
  return {"kitchen", "viewer", "query", on, refused};
}

class AuditLogTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_OK(AuditLog::create(path())); }

  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "audit.log"; }
  [[nodiscard]] std::filesystem::path state() const { return AuditLog::state_path(path()); }

  void add(const std::vector<std::string>& queries) {
    auto log = AuditLog::open(path());
    ASSERT_OK(log);
    for (const std::string& query : queries) ASSERT_OK((*log)->add(event(query)));
  }

  static std::string text_of(const std::filesystem::path& file) {
    const auto bytes = read_file(file);
    EXPECT_OK(bytes);
    return std::string(as_text(bytes->bytes()));
  }

  static void write(const std::filesystem::path& file, const std::string& text) {
    engram::testing::write_secret(file, text);
  }

  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> all;
    std::istringstream text(text_of(path()));
    for (std::string line; std::getline(text, line);) all.push_back(line);
    return all;
  }

  void write_lines(const std::vector<std::string>& lines) const {
    write(path(), fmt::format("{}\n", fmt::join(lines, "\n")));
  }

  [[nodiscard]] AuditReport check() const {
    const auto report = check_audit_log(path(), AuditLog::key_path(path()), {}, {});
    EXPECT_OK(report);
    return report.ok() ? *report : AuditReport();
  }

  /// What the flaws say, with their lines.
  [[nodiscard]] std::string flaws() const {
    std::string text;
    for (const AuditFlaw& flaw : check().flaws)
      text += fmt::format("{}: {}\n", flaw.line, flaw.what);
    return text;
  }

  ScratchDirectory folder_;
};

TEST_F(AuditLogTest, KeepsWhoAskedWhat) {
  add({"Vision @ latest", "Robot"});
  add({"after a restart"});
  const auto all = lines();
  ASSERT_EQ(all.size(), 3U);
  const auto first = nlohmann::json::parse(all[0]);
  EXPECT_EQ(first["record"], 0);
  EXPECT_EQ(first["server"], "kitchen");
  EXPECT_EQ(first["who"], "viewer");
  EXPECT_EQ(first["did"], "query");
  EXPECT_EQ(first["on"], "Vision @ latest");
  EXPECT_FALSE(first.contains("refused"));
  EXPECT_OK(parse_time(first["time"].get<std::string>()));
  EXPECT_EQ(nlohmann::json::parse(all[2])["record"], 2);
  const AuditReport report = check();
  EXPECT_TRUE(report.is_whole()) << flaws();
  EXPECT_EQ(report.whole, 3U);
  EXPECT_EQ(report.seal, nlohmann::json::parse(all[2])["seal"]);
}

TEST_F(AuditLogTest, IsWholeWhileItIsEmpty) {
  EXPECT_TRUE(check().is_whole());
  add({});
  EXPECT_TRUE(check().is_whole());
}

TEST_F(AuditLogTest, IsReadByItsOwnerAlone) {
  for (const auto& file : {path(), state(), AuditLog::key_path(path())}) {
    struct stat info {};
    ASSERT_EQ(::stat(file.c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0600U) << file;
  }
  EXPECT_FAILS(AuditLog::create(path()), StatusCode::kAlreadyExists, "is there already");
  EXPECT_FAILS(AuditLog::open(folder_.path() / "other"), StatusCode::kNotFound,
               "engram audit create");
  std::filesystem::permissions(state(), static_cast<std::filesystem::perms>(0644));
  EXPECT_FAILS(AuditLog::open(path()), StatusCode::kFailedPrecondition, "0600");
}

TEST_F(AuditLogTest, HasOneWriter) {
  const auto log = AuditLog::open(path());
  ASSERT_OK(log);
  EXPECT_FAILS(AuditLog::open(path()), StatusCode::kFailedPrecondition, "another process");
}

TEST_F(AuditLogTest, FindsEveryByteThatWasChanged) {
  add({"Vision @ latest", "Robot", "Speech"});
  const std::string whole = text_of(path());
  for (size_t at = 0; at < whole.size(); ++at)
    for (const char mask : {1, 32, 0x7f}) {
      std::string changed = whole;
      changed[at] = static_cast<char>(changed[at] ^ mask);
      write(path(), changed);
      ASSERT_FALSE(check().is_whole()) << at << " " << int{mask} << "\n" << changed;
    }
}

TEST_F(AuditLogTest, FindsRecordsThatWereLeftOut) {
  add({"a", "b", "c", "d"});
  const auto whole = lines();
  for (size_t at = 0; at < whole.size(); ++at) {
    auto fewer = whole;
    fewer.erase(fewer.begin() + static_cast<ptrdiff_t>(at));
    write_lines(fewer);
    EXPECT_THAT(flaws(), HasSubstr(fmt::format("record {} is missing", at)));
    EXPECT_EQ(check().whole, 3U);
  }
  write_lines({whole[0], whole[3]});
  EXPECT_THAT(flaws(), HasSubstr("2: records 1 to 2 are missing"));
  write(path(), "");
  EXPECT_THAT(flaws(), HasSubstr("records 0 to 3 are missing at the end"));
}

TEST_F(AuditLogTest, FindsThatItsEndWasCut) {
  add({"a", "b", "c"});
  const std::string whole = text_of(path());
  for (size_t size = 0; size < whole.size(); ++size) {
    write(path(), whole.substr(0, size));
    ASSERT_FALSE(check().is_whole()) << size;
  }
  // Nor does it help to remove the state.
  std::filesystem::remove(state());
  EXPECT_THAT(flaws(), HasSubstr("its state is not beside it"));
}

TEST_F(AuditLogTest, FindsRecordsInWrongPlaces) {
  add({"a", "b", "c"});
  const auto whole = lines();
  for (const auto& order : std::vector<std::vector<size_t>>{
           {1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {0, 0, 1, 2}, {0, 1, 2, 2}, {0, 1, 0, 2}}) {
    std::vector<std::string> moved;
    for (const size_t at : order) moved.push_back(whole[at]);
    write_lines(moved);
    EXPECT_FALSE(check().is_whole()) << fmt::format("{}", fmt::join(order, " "));
  }
}

TEST_F(AuditLogTest, CannotBeRewrittenByWhoTakesOverTheMachine) {
  add({"a", "what the burglar looked at", "c"});
  // All that is on the machine then: the log, and the key of the next record.
  AuditLink stolen = *read_audit_state(state());
  const auto whole = lines();
  const auto told = parse_audit_line(whole[1]);
  ASSERT_TRUE(told.has_value());
  AuditLink forged = stolen;
  forged.record = 1;
  forged.seal = told->before;
  std::string line = forged.line_of("\"time\":\"\",\"who\":\"nobody\"");
  line.pop_back();
  write_lines({whole[0], line, whole[2]});
  EXPECT_THAT(flaws(), HasSubstr("record 1 was changed"));
  // Without what follows, and with a state that fits the shorter log.
  write_lines({whole[0]});
  forged.bytes = whole[0].size() + 1;
  write(state(), to_text(forged));
  EXPECT_THAT(flaws(), HasSubstr("its state is that of another log"));
  // And on with records of his own.
  forged.seal = parse_audit_line(whole[0])->seal;
  write(path(), whole[0] + "\n" + forged.line_of("\"who\":\"nobody\""));
  EXPECT_THAT(flaws(), HasSubstr("record 1 was changed"));
}

TEST_F(AuditLogTest, GoesOnAfterAKill) {
  add({"a"});
  const std::string before = text_of(state());
  add({"b"});
  // Killed between the record and the state.
  write(state(), before);
  EXPECT_TRUE(check().is_whole()) << flaws();
  add({"c"});
  EXPECT_TRUE(check().is_whole()) << flaws();
  ASSERT_EQ(lines().size(), 3U);
  // Killed in the midst of a record.
  const std::string whole = text_of(path());
  write(path(), whole + whole.substr(0, 50));
  ::testing::internal::CaptureStderr();
  add({"d"});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("50 bytes of a record"));
  EXPECT_TRUE(check().is_whole()) << flaws();
  EXPECT_EQ(lines().size(), 4U);
}

TEST_F(AuditLogTest, GoesOnButTellsWhereItsEndIsMissing) {
  add({"a", "b", "c"});
  const std::string whole = text_of(path());
  write(path(), whole.substr(0, whole.size() - 10));
  ::testing::internal::CaptureStderr();
  add({"d"});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("10 bytes are missing"));
  EXPECT_THAT(flaws(), HasSubstr("3: is no record"));
  EXPECT_THAT(flaws(), HasSubstr("record 2 is missing"));
  EXPECT_EQ(check().whole, 3U);
}

TEST_F(AuditLogTest, GoesOnButTellsWhatNoServerWrote) {
  add({"a"});
  write(path(), text_of(path()) + "put in\n");
  ::testing::internal::CaptureStderr();
  add({"b"});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("no server wrote"));
  EXPECT_THAT(flaws(), HasSubstr("2: is no record"));
  EXPECT_EQ(check().whole, 2U);
}

TEST_F(AuditLogTest, NeedsItsOwnKey) {
  add({"a", "b"});
  const auto other = folder_.path() / "other.log";
  ASSERT_OK(AuditLog::create(other));
  const auto report = check_audit_log(path(), AuditLog::key_path(other), {}, {});
  ASSERT_OK(report);
  ASSERT_FALSE(report->flaws.empty());
  EXPECT_THAT(report->flaws[0].what, HasSubstr("is it that of this log?"));
  EXPECT_EQ(report->whole, 0U);
}

TEST_F(AuditLogTest, IsAsciiAndBounded) {
  const std::string hostile =
      "\x1b]0;owned\x07\n{\"record\":9}\xff\xc3\x28" + std::string(100'000, 'x');
  add({hostile});
  const auto all = lines();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_LT(all[0].size(), 6000U);
  for (const char c : all[0]) ASSERT_TRUE(c >= 32 && c < 127) << int{c};
  EXPECT_THAT(all[0], HasSubstr(fmt::format("({} bytes, SHA-256 ", hostile.size())));
  EXPECT_TRUE(check().is_whole()) << flaws();
}

TEST_F(AuditLogTest, CountsRefusalsOfManyHolders) {
  constexpr int kHolders = 3000;
  {
    const auto log = AuditLog::open(path());
    ASSERT_OK(log);
    for (int i = 0; i < 2 * kHolders; ++i)
      ASSERT_OK((*log)->add(
          {"kitchen", fmt::format("holder {}", i % kHolders), "query", "Vision", "no access"}));
  }
  uint64_t refused = 0;
  for (const std::string& line : lines())
    refused += nlohmann::json::parse(line).value("times", uint64_t{1});
  EXPECT_EQ(refused, 2U * kHolders);
}

TEST_F(AuditLogTest, CountsRefusalsThatRepeat) {
  {
    const auto log = AuditLog::open(path());
    ASSERT_OK(log);
    for (int i = 0; i < 10'000; ++i) ASSERT_OK((*log)->add(event("Vision", "no access")));
    ASSERT_OK((*log)->add(event("Vision")));
  }
  uint64_t refused = 0;
  for (const std::string& line : lines()) {
    const auto json = nlohmann::json::parse(line);
    if (json.contains("refused")) refused += json.value("times", uint64_t{1});
  }
  EXPECT_EQ(refused, 10'000U);
  EXPECT_LT(lines().size(), 20U);
  EXPECT_TRUE(check().is_whole()) << flaws();
}

TEST_F(AuditLogTest, TakesRecordsOfManyThreadsWhileItIsVerified) {
  constexpr int kThreads = 4, kEach = 500;
  {
    const auto log = AuditLog::open(path());
    ASSERT_OK(log);
    std::vector<std::jthread> threads;
    for (int i = 0; i < kThreads; ++i)
      threads.emplace_back([&log] {
        for (int k = 0; k < kEach; ++k) EXPECT_OK((*log)->add(event("Vision")));
      });
    for (int i = 0; i < 20; ++i) EXPECT_THAT(flaws(), Not(HasSubstr("missing")));
  }
  EXPECT_EQ(check().whole, uint64_t{kThreads} * kEach);
  EXPECT_TRUE(check().is_whole()) << flaws();
}

TEST_F(AuditLogTest, VerifiesHostileFilesInLittleRam) {
  add({"a"});
  write(path(), text_of(path()) + std::string(5'000'000, 'x') + "\n" +
                    R"({"record":18446744073709551615,"who":"","before":")" + std::string(64, '0') +
                    R"(","seal":")" + std::string(64, '0') + "\"}\n");
  EXPECT_THAT(flaws(), HasSubstr("is no record"));
  EXPECT_THAT(flaws(), HasSubstr("says it is record 18446744073709551615"));
  std::filesystem::remove(path());
  ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
  EXPECT_FAILS(check_audit_log(path(), AuditLog::key_path(path()), {}, {}),
               StatusCode::kUnavailable, "named pipe");
}

}  // namespace
}  // namespace engram::server
