// SPDX-License-Identifier: Apache-2.0
#include "cli/driver_processes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"

namespace engram::cli {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Not;

/// Runs shell scripts as drivers until one of them says `last`.
class Drivers : public ::testing::Test {
 protected:
  Status run(const std::vector<DriverProcess>& drivers, const std::string& last) {
    return run_drivers(drivers,
                       {.on_line =
                            [&](const std::string& driver, const std::string& line) {
                              lines_.push_back(driver + ": " + line);
                              is_over_ = is_over_ || line == last;
                              if (line == stops_at_) stop_.request_stop();
                            },
                        .on_end = [&](const std::string& driver, int code,
                                      Duration) { ends_.emplace_back(driver, code); },
                        .is_over = [&] { return is_over_; }},
                       stop_.get_token());
  }

  static DriverProcess script(const std::string& name, const std::string& text,
                              bool ends_by_itself) {
    return {name, {"sh", "-c", text}, ends_by_itself};
  }

  std::vector<std::string> lines_;
  std::vector<std::pair<std::string, int>> ends_;
  bool is_over_ = false;
  std::string stops_at_;  ///< The line at which a stop is requested.
  std::stop_source stop_;
};

constexpr const char* kSaysGoodbye =
    "trap 'echo goodbye; exit' TERM; echo here; while :; do sleep 0.02; done";

TEST_F(Drivers, AreToldOfTheEndUnlessTheySeeItThemselves) {
  ASSERT_OK(run({script("skills", kSaysGoodbye, false),
                 script("state", "trap 'echo told' TERM; sleep 0.3; echo done", true)},
                "here"));
  EXPECT_THAT(lines_, Contains("skills: goodbye"));
  EXPECT_THAT(lines_, Contains("state: done"));
  EXPECT_THAT(lines_, Not(Contains("state: told")));
}

TEST_F(Drivers, AreAllToldWhenAStopIsRequested) {
  stops_at_ = "here";  // It has set its trap by then.
  EXPECT_OK(run({script("state", kSaysGoodbye, true)}, "never"));
  EXPECT_THAT(lines_, Contains("state: goodbye"));
}

TEST_F(Drivers, LeaveWhatTheySaidWhenTheyAreKilled) {
  ASSERT_OK(run({script("camera", "echo one; echo two; printf three; kill -9 $$", true)}, "three"));
  EXPECT_THAT(lines_, ElementsAre("camera: one", "camera: two", "camera: three"));
}

TEST_F(Drivers, AreStartedAgain) {
  ASSERT_OK(run({script("camera", "echo $$; exit 3", true),
                 script("state", "sleep 1; echo enough; sleep 0.2", true)},
                "enough"));
  EXPECT_GE(ends_.size(), 2u);
  EXPECT_THAT(ends_, Contains(std::pair<std::string, int>("camera", 3)));
}

}  // namespace
}  // namespace engram::cli
