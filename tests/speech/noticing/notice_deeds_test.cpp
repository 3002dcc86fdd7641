// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/notice_deeds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/facts/known_facts.h"
#include "speech/language/asker.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::speech {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Time at(double seconds) {
  return time_from_ns(1'767'225'600'000'000'000) + *duration_from_seconds(seconds);
}

class Noticing : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Memory::open(scratch_.path() / "robot.engram");
    ASSERT_OK(opened);
    memory_ = *std::move(opened);
  }

  void commit(const std::string& entity, Time time, idf::Dict value) {
    ltm::Commit commit;
    commit.updates.push_back(
        {*ltm::MemoryId::parse(entity), time, {{idf::Data(std::move(value)), {}}}});
    ASSERT_OK(memory_->commit(commit));
  }

  /// Eight seconds: the right hand closes from 3.0 to 3.8 s and opens from 6.0 to 6.8 s; `sign` -1:
  /// angles that bend.
  void episode(double begins, const std::string& task, double sign = 1) {
    if (!task.empty())
      commit("Recording/Episodes/lerobot/episodes", at(begins),
             {{"format", "lerobot"},
              {"name", "episode"},
              {"attributes", idf::Dict{{"tasks", idf::List{idf::Data(task)}}}}});
    for (int i = 0; i < 80; ++i) {
      const double second = i / 10.0;
      const double closed =
          std::clamp((second - 3.0) / 0.8, 0.0, 1.0) - std::clamp((second - 6.0) / 0.8, 0.0, 1.0);
      const double open = sign > 0 ? 0.8 - 0.4 * closed : 0.2 + 1.2 * closed;
      commit("RobotState/Proprioception/robot/state", at(begins + second),
             {{"left_elbow", second}, {"left_hand_thumb", 0.5}, {"right_hand_index", open}});
    }
  }

  Noticed noticed() {
    auto found = notice_deeds(*memory_, {});
    EXPECT_OK(found);
    return found.ok() ? *std::move(found) : Noticed();
  }

  std::string answer(const std::string& question) {
    auto asker = Asker::create(*memory_, {});
    EXPECT_OK(asker);
    auto told = (*asker)->ask(question, at(100));
    EXPECT_OK(told);
    for (const Evidence& one : told->evidence) EXPECT_TRUE(one.id.time()) << one.id.printable();
    return told->text;
  }

  std::string shown(const std::string& question) {
    auto asker = Asker::create(*memory_, {});
    EXPECT_OK(asker);
    auto told = (*asker)->ask(question, at(100));
    EXPECT_OK(told);
    std::string all;
    for (const Evidence& one : told->evidence) all += one.id.to_string() + "\n";
    return all;
  }

  ScratchDirectory scratch_;
  std::unique_ptr<Memory> memory_;
};

constexpr const char* kTask = "Pick up the yellow bottle on the table.";

TEST_F(Noticing, FindsGraspsByEpisodes) {
  episode(0, kTask);
  episode(20, kTask);
  const Noticed found = noticed();
  EXPECT_EQ(found.episodes, 2u);
  ASSERT_THAT(found.deeds, SizeIs(2));
  const NoticedDeed& deed = found.deeds[1];
  EXPECT_EQ(deed.hand, "right");
  EXPECT_EQ(deed.thing, "yellow bottle");
  EXPECT_EQ(deed.place, "table");
  EXPECT_NEAR(to_seconds(*deed.close_began.time() - at(20)), 3.0, 0.2);
  EXPECT_NEAR(to_seconds(*deed.close_ended.time() - at(20)), 3.8, 0.2);
  ASSERT_TRUE(deed.open_began);
  EXPECT_NEAR(to_seconds(*deed.open_began->time() - at(20)), 6.0, 0.2);
  EXPECT_NEAR(deed.open_after, 0.4, 1e-6);
}

TEST_F(Noticing, ReadsAnglesTheOtherWayRound) {
  episode(0, "", -1);
  const Noticed found = noticed();
  ASSERT_THAT(found.deeds, SizeIs(1));
  EXPECT_NEAR(to_seconds(*found.deeds[0].close_began.time() - at(0)), 3.0, 0.2);
  EXPECT_NEAR(found.deeds[0].open_after, 1.4, 1e-6);
  EXPECT_EQ(found.deeds[0].thing, "");
}

TEST_F(Noticing, RemembersWhatCanBeAskedAbout) {
  episode(0, kTask);
  episode(20, kTask);
  const auto committed = remember_deeds(*memory_, noticed().deeds);
  ASSERT_OK(committed);
  EXPECT_EQ(*committed, 2u);
  EXPECT_THAT(answer("When did you grasp the bottle?"),
              HasSubstr("I picked up the yellow bottle from the table with my right hand"));
  EXPECT_THAT(answer("How often did you pick up the bottle?"), HasSubstr("Twice"));
  EXPECT_EQ(answer("Which hand did you use to grasp the bottle?"), "My right hand.");
  EXPECT_THAT(answer("Why did you pick up the bottle?"), HasSubstr(kTask));
  EXPECT_THAT(answer("Did you pick up the cup?"), HasSubstr("I do not know"));
  // The answers show the joints from which they were read.
  EXPECT_THAT(shown("When did you grasp the bottle?"),
              HasSubstr("RobotState/Proprioception/robot/state/2026-01-01 00:00:23"));
  const auto facts = KnownFacts::read(*memory_);
  ASSERT_OK(facts);
  ASSERT_THAT((*facts)->executions(), SizeIs(4));
  const auto event = (*facts)->value_at((*facts)->executions()[0].start_id);
  ASSERT_OK(event);
  for (const idf::Data& link : event->at("read_from")->get<idf::List>())
    EXPECT_OK((*facts)->value_at(*ltm::MemoryId::parse(link.get<std::string>())));
}

TEST_F(Noticing, RemembersOnlyWhatIsNew) {
  episode(0, kTask);
  ASSERT_OK(remember_deeds(*memory_, noticed().deeds));
  episode(20, kTask);
  const auto second = remember_deeds(*memory_, noticed().deeds);
  ASSERT_OK(second);
  EXPECT_EQ(*second, 1u);
  const auto third = remember_deeds(*memory_, noticed().deeds);
  ASSERT_OK(third);
  EXPECT_EQ(*third, 0u);
}

TEST_F(Noticing, RemembersThatAHandLetGoOnlyLater) {
  episode(0, kTask);
  std::vector<NoticedDeed> deeds = noticed().deeds;
  ASSERT_THAT(deeds, SizeIs(1));
  const auto opened = std::pair(deeds[0].open_began, deeds[0].open_ended);
  deeds[0].open_began.reset();
  deeds[0].open_ended.reset();
  ASSERT_OK(remember_deeds(*memory_, deeds));
  EXPECT_EQ(answer("Which hand holds the bottle?"), "My right hand.");
  // It is found a sample later, now that more is known.
  std::tie(deeds[0].open_began, deeds[0].open_ended) = opened;
  deeds[0].close_began = deeds[0].close_began.entity().at(at(3.2)).instance(0);
  ASSERT_OK(remember_deeds(*memory_, deeds));
  const auto facts = KnownFacts::read(*memory_);
  ASSERT_OK(facts);
  ASSERT_THAT((*facts)->executions(), SizeIs(2));
  EXPECT_EQ((*facts)->executions()[1].skill, "release");
}

TEST_F(Noticing, TellsOfBothHandsAtOnce) {
  episode(0, kTask);
  std::vector<NoticedDeed> deeds = noticed().deeds;
  deeds.push_back(deeds[0]);
  deeds[1].hand = "left";
  const auto committed = remember_deeds(*memory_, deeds);
  ASSERT_OK(committed);
  EXPECT_EQ(*committed, 2u);
  EXPECT_THAT(answer("How many times did you pick up the bottle?"), HasSubstr("Twice"));
}

TEST_F(Noticing, CallsAThingByAnyOfItsNamesTheSame) {
  episode(0, kTask);
  ASSERT_OK(remember_deeds(*memory_, noticed().deeds));
  episode(20, "Take the bottle");
  ASSERT_OK(remember_deeds(*memory_, noticed().deeds));
  EXPECT_THAT(answer("How many times did you pick up the yellow bottle?"), HasSubstr("Twice"));
  // Its class is one that the memory has.
  const auto things = memory_->query("Objects/Instances @ latest");
  ASSERT_OK(things);
  ASSERT_THAT(things->entities(), SizeIs(1));
  const idf::Data* of_class =
      things->entities()[0]->snapshots[0].instances[0].data.at("object_class");
  EXPECT_OK(memory_->query(of_class->get<std::string>() + " @ latest"));
}

TEST_F(Noticing, FindsNamesOfJointsOfOneEntityInItsDescription) {
  commit("RobotState/Description/robot/body", at(0),
         {{"joint_names", idf::List{idf::Data("elbow"), idf::Data("left_index_1")}}});
  for (int i = 0; i < 100; ++i) {
    const float bent = i < 30 || i > 60 ? 0.1F : 0.3F;
    commit("RobotState/Proprioception/robot/joints", at(i / 10.0),
           {{"positions", idf::NdArray::take({2}, std::vector<float>{1, bent})}});
  }
  NoticeOptions options;
  options.joints = *ltm::MemoryId::parse("RobotState/Proprioception/robot/joints");
  const auto found = notice_deeds(*memory_, options);
  ASSERT_OK(found);
  ASSERT_THAT(found->deeds, SizeIs(1));
  // Angles, also where they stay between 0 and 1.
  EXPECT_NEAR(found->deeds[0].open_after, 0.3, 1e-6);
}

TEST_F(Noticing, LeavesWhatOthersToldAlone) {
  episode(0, kTask);
  commit("Skill/Event/robot/pick", at(2), {{"skill", "robot/pick"}, {"outcome", int32_t{0}}});
  EXPECT_FAILS(remember_deeds(*memory_, noticed().deeds), StatusCode::kFailedPrecondition,
               "was told what the robot did");
  // Of another day nobody told.
  episode(20, kTask);
  commit("Skill/Event/robot/pick", at(8),
         {{"skill", "robot/pick"}, {"outcome", int32_t{1}}, {"started", to_ns(at(2))}});
  const auto committed = remember_deeds(*memory_, noticed().deeds);
  ASSERT_OK(committed);
  EXPECT_EQ(*committed, 1u);
}

TEST_F(Noticing, NeedsHandsAndCanBeStopped) {
  commit("RobotState/Proprioception/robot/state", at(0), {{"left_elbow", 1.0}});
  EXPECT_FAILS(notice_deeds(*memory_, {}), StatusCode::kNotFound, "joints of a hand");
  episode(1, "");
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(notice_deeds(*memory_, {}, {}, stop.get_token()), StatusCode::kCancelled, "stopped");
}

}  // namespace
}  // namespace engram::speech
