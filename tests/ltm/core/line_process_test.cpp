// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/line_process.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram {
namespace {

using namespace std::chrono_literals;

TEST(LineProcess, AnswersLineByLine) {
  LineProcess process;
  ASSERT_OK(process.start({"cat"}));
  ASSERT_OK(process.write_line("one"));
  ASSERT_OK(process.write_line("two"));
  EXPECT_EQ(*process.read_line(10s), "one");
  EXPECT_EQ(*process.read_line(10s), "two");
}

TEST(LineProcess, TellsTheLastWordsOfOneThatEnded) {
  LineProcess process;
  ASSERT_OK(process.start({"sh", "-c", "echo it is broken >&2"}));
  ASSERT_OK(process.read_line(10s));
  EXPECT_FAILS(process.read_line(10s), StatusCode::kUnavailable, "it is broken");
}

TEST(LineProcess, DoesNotWaitForever) {
  LineProcess process;
  ASSERT_OK(process.start({"cat"}));
  EXPECT_FAILS(process.read_line(20ms), StatusCode::kUnavailable, "gave no answer in time");
}

TEST(LineProcess, DoesNotWaitForOneThatReadsNothing) {
  LineProcess process;
  ASSERT_OK(process.start({"sleep", "60"}));
  const std::vector<std::byte> much(size_t{16} << 20);
  EXPECT_FAILS(process.write(much, steady_now() + 20ms), StatusCode::kUnavailable,
               "does not read in time");
}

TEST(LineProcess, EndsAWaitOnAStop) {
  LineProcess process;
  ASSERT_OK(process.start({"cat"}));
  std::stop_source stop;
  const std::jthread stopping([&stop] {
    std::this_thread::sleep_for(20ms);
    stop.request_stop();
  });
  EXPECT_FAILS(process.read_line(steady_now() + 60s, stop.get_token()), StatusCode::kCancelled,
               "stopped");
}

TEST(LineProcess, RefusesALineThatIsTooLong) {
  LineProcess process;
  ASSERT_OK(process.start({"cat", "/dev/zero"}, {.max_line = 100'000}));
  EXPECT_FAILS(process.read_line(60s), StatusCode::kUnavailable, "more than 100000 bytes");
}

TEST(LineProcess, LetsItEndByItselfAndKillsItsChildren) {
  const ScratchDirectory scratch;
  LineProcess process;
  ASSERT_OK(
      process.start({"sh", "-c", "sleep 100 & echo $!; cat; touch \"$0\"", scratch / "ended"}));
  const auto child = process.read_line(10s);
  ASSERT_OK(child);
  process.end(10s);
  EXPECT_TRUE(std::filesystem::exists(scratch / "ended"));
  // It is nobody's child any more, so whoever adopts it may take a while to bury it.
  bool is_gone = false;
  for (int i = 0; i < 500 && !is_gone; ++i) {
    std::ifstream state("/proc/" + *child + "/stat");
    std::string line;
    is_gone = !std::getline(state, line) || line.find(") Z ") != std::string::npos;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(is_gone);
}

TEST(LineProcess, SaysWhatIsNotThere) {
  LineProcess process;
  EXPECT_FAILS(process.start({"no-such-program"}), StatusCode::kNotFound, "'no-such-program'");
}

}  // namespace
}  // namespace engram
