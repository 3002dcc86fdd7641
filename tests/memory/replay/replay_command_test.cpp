// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_command.h"

#include <gtest/gtest.h>

#include "ltm/memory/score_id.h"
#include "memory/replay/replay_state.h"
#include "tests/ltm/expect_status.h"

namespace engram {
namespace {

TEST(ReplayCommand, IsReadAsItWasWritten) {
  using Kind = ReplayCommand::Kind;
  const ReplayLoop loop{time_from_ns(5), time_from_ns(9)};
  for (const ReplayCommand& command : std::vector<ReplayCommand>{{Kind::kPlay},
                                                                 {Kind::kPause},
                                                                 {Kind::kStep},
                                                                 {Kind::kSeek, time_from_ns(7)},
                                                                 {Kind::kSpeed, {}, 2.5},
                                                                 {Kind::kLoop, {}, 1, loop},
                                                                 {Kind::kLoop}}) {
    const auto read = ReplayCommand::from_data(command.to_data());
    ASSERT_OK(read);
    EXPECT_EQ(*read, command);
    EXPECT_OK(commit_of(command).check());
  }
}

TEST(ReplayCommand, TakesTimesAndNumbersAsPeopleWriteThem) {
  const auto seek = ReplayCommand::from_data(
      idf::Dict{{"command", std::string("seek")}, {"time", std::string("1970-01-01 00:00:01")}});
  ASSERT_OK(seek);
  EXPECT_EQ(to_ns(seek->time), 1'000'000'000);
  const auto speed =
      ReplayCommand::from_data(idf::Dict{{"command", std::string("speed")}, {"speed", int32_t{3}}});
  ASSERT_OK(speed);
  EXPECT_EQ(speed->speed, 3);
}

TEST(ReplayState, IsReadAsItWasWritten) {
  ReplayState state;
  state.stores = {"a.engram", "b.engram"};
  state.now = time_from_ns(17);
  state.speed = 2;
  state.is_playing = true;
  state.loop = ReplayLoop{time_from_ns(1), time_from_ns(2)};
  state.first = time_from_ns(1);
  state.last = time_from_ns(99);
  state.jumps = 3;
  state.told = 4;
  state.scored = 5;
  state.bounded = 4;
  state.within_bound = 3;
  state.unscored = 2;
  const auto read = ReplayState::from_data(state.to_data());
  ASSERT_OK(read);
  EXPECT_EQ(*read, state);
  EXPECT_FALSE(ReplayState::from_data(idf::Data(7)).ok());
  EXPECT_FALSE(ReplayState::from_data(idf::Dict{{"now", 1.5}}).ok());
}

TEST(ReplayState, NamesTheScoresOfAnEntityByItsId) {
  const ltm::MemoryId cup = *ltm::MemoryId::parse("Objects/Things/a\\/b/cup");
  EXPECT_EQ(ltm::score_id(cup).names().back(), "Objects/Things/a\\/b/cup");
}

}  // namespace
}  // namespace engram
