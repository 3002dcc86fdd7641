// SPDX-License-Identifier: Apache-2.0
// `engram skill why` of a snapshot: what led to it, from a store, in words and as JSON.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ltm/core/time.h"
#include "ltm/recording/recorder.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::cli {
namespace {

using navigation::testing::kBegin;
using std::chrono::seconds;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const ltm::MemoryId kSpeech = *ltm::MemoryId::parse("Speech/Commands/human/text");
const ltm::MemoryId kRequests = *ltm::MemoryId::parse("Skill/ExecutionRequest/human/drive");
const ltm::MemoryId kPlans = *ltm::MemoryId::parse("Navigation/Plan/robot/drive");
const ltm::MemoryId kEvents = *ltm::MemoryId::parse("Navigation/Event/robot/drive");

class SkillWhy : public ::testing::Test {
 protected:
  SkillWhy() {
    auto recorder = ltm::Recorder::open(store_, {});
    ENGRAM_CHECK(recorder.ok(), "{}", recorder.status().message());
    const auto record = [&](const ltm::MemoryId& entity, Time time, const idf::Data& value) {
      ENGRAM_CHECK(recorder->commit({{{entity, time, {{value, {}}}}}}).ok(), "not recorded");
    };
    const auto link = [](const ltm::MemoryId& entity) {
      return entity.at(kBegin).instance(0).to_data();
    };
    record(kSpeech, kBegin, idf::Dict{{"text", "Please move to the table!"}});
    record(kRequests, kBegin,
           idf::Dict{{"skill", "robot/drive"}, {"causes", idf::List{link(kSpeech)}}});
    record(kPlans, kBegin, idf::Dict{{"goal", "table"}, {"request", link(kRequests)}});
    record(kEvents, kBegin, idf::Dict{{"reason", "drives to 'table'"}, {"plan", link(kPlans)}});
    record(kEvents, kBegin + seconds(9),
           idf::Dict{{"reason", "stands at 'table'"}, {"plan", link(kPlans)}});
    ENGRAM_CHECK(recorder->close().ok(), "not closed");
  }

  [[nodiscard]] RunResult why(const std::string& what, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"skill", "why", what, "--db", store_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_engram(arguments);
  }

  ScratchDirectory directory_;
  std::string store_ = directory_.path() / "store";
};

TEST_F(SkillWhy, LeadsFromTheLastEventOfADriveToTheWordsThatWereSaid) {
  const RunResult told = why(kEvents.to_string());
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(
      told.out,
      "Navigation/Event/robot/drive/2023-11-14 22:13:29.000000/0 (stands at 'table')\n"
      "because of its plan: Navigation/Plan/robot/drive/2023-11-14 22:13:20.000000/0 (table)\n"
      "because of its request: Skill/ExecutionRequest/human/drive/2023-11-14 "
      "22:13:20.000000/0 (robot/drive)\n"
      "because of its causes: Speech/Commands/human/text/2023-11-14 22:13:20.000000/0 "
      "(Please move to the table!)\n");
}

TEST_F(SkillWhy, TellsOfASnapshotAsJson) {
  const RunResult told = why(kEvents.at(kBegin).to_string(), {"--json"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  const Json steps = Json::parse(told.out, nullptr, false).value("why", Json::array());
  ASSERT_EQ(steps.size(), 4U) << told.out;
  EXPECT_EQ(steps[0]["says"], "drives to 'table'");
  EXPECT_EQ(steps[1]["member"], "plan");
  EXPECT_EQ(steps[3]["id"], kSpeech.at(kBegin).instance(0).to_string());
  EXPECT_EQ(steps[3]["says"], "Please move to the table!");
}

TEST_F(SkillWhy, RefusesWhatIsNotThereAndParametersOfASnapshot) {
  const RunResult none = why("Navigation/Event/robot/fly");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("Navigation/Event/robot/fly"));
  const RunResult given = why(kEvents.to_string(), {"to=table"});
  EXPECT_EQ(given.exit_code, 1);
  EXPECT_THAT(given.err, HasSubstr("has no parameters"));
  // The name of a skill is asked for as before.
  EXPECT_NE(why("drive").exit_code, 0);
}

}  // namespace
}  // namespace engram::cli
