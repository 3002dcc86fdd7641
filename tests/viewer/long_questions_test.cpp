// SPDX-License-Identifier: Apache-2.0
#include "viewer/long_questions.h"

#include <thread>

#include "tests/ltm/expect_status.h"

namespace engram::viewer {
namespace {

constexpr Duration kForever = std::chrono::hours(1);

void wait_for_stop(const std::stop_token& stop) {
  while (!stop.stop_requested()) std::this_thread::yield();
}

TEST(LongQuestions, EndAtTheirTime) {
  LongQuestions questions;
  const auto running = questions.begin("a", std::chrono::milliseconds(5));
  ASSERT_OK(running);
  wait_for_stop((*running)->stop());
  const Status told = (*running)->explained(cancelled("stopped"), "the plan");
  EXPECT_EQ(told.code(), StatusCode::kResourceExhausted);
  EXPECT_THAT(told.message(), ::testing::HasSubstr("the plan takes longer than 5ms"));
  EXPECT_EQ((*running)->explained(data_loss("x"), "the plan").code(), StatusCode::kDataLoss);
}

TEST(LongQuestions, GiveWayToTheNextOneOfTheSamePage) {
  LongQuestions questions;
  const auto first = questions.begin("a", kForever);
  const auto other = questions.begin("b", kForever);
  ASSERT_OK(first);
  ASSERT_OK(other);
  EXPECT_FAILS(questions.begin("c", kForever), StatusCode::kUnavailable, "ask again");
  const auto second = questions.begin("a", kForever);
  ASSERT_OK(second);
  EXPECT_TRUE((*first)->stop().stop_requested());
  EXPECT_EQ((*first)->explained(cancelled(""), "it").code(), StatusCode::kUnavailable);
  EXPECT_FALSE((*other)->stop().stop_requested());
  EXPECT_FALSE((*second)->stop().stop_requested());
}

TEST(LongQuestions, AreCalledOff) {
  LongQuestions questions;
  const auto one = questions.begin("a", kForever);
  auto other = questions.begin("b", kForever);
  questions.call_off("c");
  EXPECT_FALSE((*one)->stop().stop_requested());
  questions.call_off("a");
  EXPECT_TRUE((*one)->stop().stop_requested());
  EXPECT_FALSE((*other)->stop().stop_requested());
  questions.call_off_all();
  EXPECT_TRUE((*other)->stop().stop_requested());
  // Those that ended make room.
  other = questions.begin("d", kForever);
  EXPECT_OK(other);
}

}  // namespace
}  // namespace engram::viewer
