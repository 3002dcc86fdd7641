// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::log {
namespace {

TEST(Log, WritesToStderrWhatReachesTheLevel) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  set_level(Level::kWarning);
  info("hidden {}", 1);
  warning("shown {} {{}}", 2);
  set_level(Level::kOff);
  warning("hidden {}", 3);
  set_level(Level::kInfo);
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, ::testing::HasSubstr("shown 2 {}"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("hidden")));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST(Log, WritesAnObjectPerLineForPrograms) {
  ::testing::internal::CaptureStderr();
  set_form(Form::kJson);
  warning("a \"quoted\" \\ and\nmore");
  set_form(Form::kText);
  const std::string line = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(line, ::testing::MatchesRegex(
                        R"(\{"time":"[0-9-]+T[0-9:.]+Z","level":"warning","message":.*\}[[:space:]])"));
  EXPECT_THAT(line, ::testing::HasSubstr(R"("a \"quoted\" \\ and\u000amore")"));
}

}  // namespace
}  // namespace engram::log
