// SPDX-License-Identifier: Apache-2.0
// `engram notice`: deeds in the joints of hands, and a store that is asked about them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "memory/memory.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class Notice : public ::testing::Test {
 protected:
  void SetUp() override {
    auto memory = Memory::open(store());
    ASSERT_OK(memory);
    const Time begin = time_from_ns(1'767'225'600'000'000'000);
    for (int i = 0; i < 100; ++i) {
      // It closes at 3 s, and opens at 6 s.
      const double open = i < 30 || i > 60 ? 0.8 : 0.4;
      ltm::Commit commit;
      commit.updates.push_back({*ltm::MemoryId::parse("RobotState/Joints/robot/arm"),
                                begin + std::chrono::milliseconds(100 * i),
                                {{idf::Data(idf::Dict{{"left_gripper", open}}), {}}}});
      ASSERT_OK((*memory)->commit(commit));
    }
    ASSERT_OK((*memory)->close());
  }

  [[nodiscard]] std::string store() const { return (folder_.path() / "robot.engram").string(); }

  ScratchDirectory folder_;
};

TEST_F(Notice, TellsAndWritesNothingUnlessItIsToldTo) {
  const RunResult run = run_engram({"notice", store()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left     something; let go after"));
  EXPECT_THAT(run.out, HasSubstr("1 deed in 100 snapshots of joints"));
  const Json report = Json::parse(run_engram({"notice", store(), "--json"}).out, nullptr, false);
  ASSERT_EQ(report["deeds"].size(), 1u);
  EXPECT_EQ(report["deeds"][0]["hand"], "left");
  EXPECT_EQ(report["deeds"][0]["joints"].size(), 4u);
  EXPECT_EQ(report["committed"], 0);
  EXPECT_THAT(run_engram({"ask", store(), "Which hand did you use?"}).out,
              HasSubstr("I do not know"));
}

TEST_F(Notice, LetsTheStoreBeAsked) {
  ASSERT_EQ(run_engram({"notice", store(), "--commit"}).exit_code, 0);
  EXPECT_THAT(run_engram({"ask", store(), "When did you pick something up?"}).out,
              HasSubstr("I picked up with my left hand"));
  EXPECT_THAT(run_engram({"notice", store(), "--commit"}).out, HasSubstr("0 committed"));
}

TEST_F(Notice, SaysWhatItNeeds) {
  const RunResult none = run_engram({"notice", store(), "--joints", "Vision/RGB/head/cam"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("joints of a hand"));
  EXPECT_EQ(run_engram({"notice", store(), "--open", "wide"}).exit_code, 2);
  EXPECT_EQ(run_engram({"notice", (folder_.path() / "nothing").string()}).exit_code, 1);
}

}  // namespace
}  // namespace engram::cli
