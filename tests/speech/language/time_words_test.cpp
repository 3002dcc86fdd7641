// SPDX-License-Identifier: Apache-2.0
#include "speech/language/time_words.h"

#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

struct Taken {
  AskedTimes times;
  std::string left;  ///< The words that are no times.
};

Taken taken_from(std::string_view question) {
  auto words = split_words(question);
  EXPECT_OK(words);
  if (!words.ok()) return {};
  Taken taken{take_times(*words, testing::second(60), DayZone::kUtc), {}};
  for (const QuestionWord& word : *words) taken.left += (taken.left.empty() ? "" : " ") + word.text;
  return taken;
}

TEST(TimeWords, AreTakenOutOfTheQuestion) {
  const Taken taken = taken_from("What did you do this morning?");
  EXPECT_EQ(taken.times.during, "today/morning");
  EXPECT_EQ(taken.left, "what did you do");
}

TEST(TimeWords, TellMoments) {
  EXPECT_EQ(taken_from("Where were you at 8:00:12?").times.at, "08:00:12");
  EXPECT_EQ(taken_from("Where were you half a minute ago?").times.at, "now-30s");
  EXPECT_EQ(taken_from("Where were you at 8:00:12 yesterday?").times.at, "yesterday/08:00:12");
}

TEST(TimeWords, TellSpans) {
  EXPECT_EQ(taken_from("What happened between 8:05 and 8:10?").times.during, "08:05..08:10");
  EXPECT_EQ(taken_from("What happened in the last ten seconds?").times.during, "last:10s");
  EXPECT_EQ(taken_from("What happened after 8:05?").times.after, "08:05");
  EXPECT_EQ(taken_from("What happened before noon?").times.before, "12:00");
}

TEST(TimeWords, TellNumbersInWords) {
  EXPECT_EQ(taken_from("Where were you seventy seconds ago?").times.at, "now-70s");
  EXPECT_EQ(taken_from("Where were you twenty-five seconds ago?").times.at, "now-25s");
  EXPECT_EQ(taken_from("What happened in the last eighty two minutes?").times.during, "last:82m");
  EXPECT_EQ(taken_from("Where were you a hundred seconds ago?").times.at, "now-100s");
  EXPECT_EQ(taken_from("Where were you a minute ago?").times.at, "now-1m");
}

TEST(TimeWords, StayWhereNoTimeFollows) {
  const Taken taken = taken_from("What did you do after you placed the salt?");
  EXPECT_TRUE(taken.times.empty());
  EXPECT_EQ(taken.left, "what did you do after you placed the salt");
}

TEST(TimeWords, TellOfPresentAndFuture) {
  EXPECT_TRUE(taken_from("What are you doing right now?").times.is_now);
  EXPECT_TRUE(taken_from("What will you do tomorrow?").times.is_future);
  EXPECT_FALSE(taken_from("What did you do?").times.is_now);
}

}  // namespace
}  // namespace engram::speech
