// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/lived_past.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/speech/dialogues/recorded_kitchens.h"

namespace engram::speech::dialogues {
namespace {

const std::string kPick = "Skill/Event/robot/pick";

Time at_second(int64_t second) {
  return *parse_time("2026-01-01 08:00:00") + std::chrono::seconds(second);
}

/// A recording of a minute that somebody wrote by hand.
class ForgedPast : public ::testing::Test {
 protected:
  ForgedPast() {
    auto opened = Memory::open(scratch_.path() / "forged.engram");
    ENGRAM_CHECK(opened.ok(), "{}", opened.status().to_string());
    memory_ = *std::move(opened);
  }

  void commit(const std::string& entity, int64_t second, idf::Dict value) {
    const auto id = ltm::MemoryId::parse(entity);
    ASSERT_OK(id);
    ASSERT_OK(memory_->commit({{{*id, at_second(second), {{idf::Data(std::move(value)), {}}}}}}));
  }
  void record(double seconds = 60) {
    commit("Simulation/Recording/kitchen/recording", 0, {{"seconds", seconds}, {"seed", 1}});
  }
  static std::string link(const std::string& entity, int64_t second) {
    return (*ltm::MemoryId::parse(entity)).at(at_second(second)).instance(0).to_string();
  }
  void begin(int64_t second, int outcome = 0) {
    commit(kPick, second,
           {{"stage", 0}, {"outcome", outcome}, {"skill", "robot/pick"}, {"hand", "left"}});
  }
  void end(int64_t second, int64_t begun, int outcome, const std::string& stopped_by) {
    idf::List links;
    links.emplace_back(stopped_by);
    commit(kPick, second,
           {{"stage", 2},
            {"outcome", outcome},
            {"skill", "robot/pick"},
            {"hand", "left"},
            {"reason", ""},
            {"execution", link(kPick, begun)},
            {"stopped_by", std::move(links)}});
  }
  void expect_refusal(const std::string& why) {
    EXPECT_FAILS(LivedPast::read(*memory_), StatusCode::kInvalidArgument, why);
  }

  ScratchDirectory scratch_;
  std::unique_ptr<Memory> memory_;
};

TEST_F(ForgedPast, IsReadWhereItIsWhole) {
  record();
  begin(2, 1);
  begin(4);
  end(7, 4, 3, link("Speech/Commands/human/text", 6));
  const auto past = LivedPast::read(*memory_);
  ASSERT_OK(past);
  ASSERT_EQ(past->actions.size(), 2U);
  // Only an end tells how it ended.
  EXPECT_EQ(past->actions[0].outcome, "running");
  EXPECT_EQ(past->actions[1].outcome, "stop");
  EXPECT_EQ(past->actions[1].stopped_by.size(), 1U);
}

TEST_F(ForgedPast, IsRefusedWithAnUnknownOutcome) {
  record();
  begin(4);
  end(7, 4, 5, link("Speech/Commands/human/text", 6));
  expect_refusal("member 'outcome' is");
}

TEST_F(ForgedPast, IsRefusedWithALinkToNoInstance) {
  record();
  begin(4);
  end(7, 4, 3, "Speech/Commands/human/text");
  expect_refusal("needs a list of links to instances");
}

TEST_F(ForgedPast, IsRefusedWithAnEndOfNothing) {
  record();
  end(7, 4, 1, link("Speech/Commands/human/text", 6));
  expect_refusal("needs an event at which it began");
}

TEST_F(ForgedPast, IsRefusedWithAnEndBeforeItsBegin) {
  record();
  begin(8);
  end(7, 8, 1, link("Speech/Commands/human/text", 6));
  expect_refusal("before it began");
}

TEST_F(ForgedPast, IsRefusedWithALengthThatIsNone) {
  record(std::numeric_limits<double>::quiet_NaN());
  expect_refusal("member 'seconds' is");
}

TEST_F(ForgedPast, IsRefusedWithAPlatformOfOtherNumbers) {
  record();
  commit("RobotState/Localization/robot/platform", 1,
         {{"pose_world_platform", idf::NdArray::take({3}, std::vector<double>(3))}});
  expect_refusal("needs three numbers");
}

TEST(LivedPast, KnowsNothingOfWhatComesLater) {
  const auto past = LivedPast::read(kitchen_of_seed_1());
  ASSERT_OK(past);
  // The first grasp of the coffee went on from 8:00:22.2 to 8:00:23.5, and nobody had said stop.
  const Time now = *parse_time("2026-01-01 08:00:23");
  const LivedPast then = past->until(now);
  EXPECT_EQ(then.last_moment(), now);
  EXPECT_EQ(then.actions.back().skill, "pick");
  EXPECT_EQ(then.actions.back().outcome, "running");
  EXPECT_FALSE(then.actions.back().over);
  EXPECT_TRUE(then.actions.back().stopped_by.empty());
  EXPECT_EQ(then.words.size(), 2U);
  EXPECT_EQ(then.plans.size(), 2U);
  ASSERT_FALSE(then.sights.empty());
  for (const auto& [thing, sights] : then.sights) EXPECT_LE(sights.back().time, now) << thing;
  EXPECT_LE(then.stands.back().time, now);
  EXPECT_EQ(past->until(past->last_moment()).actions.size(), past->actions.size());
}

}  // namespace
}  // namespace engram::speech::dialogues
