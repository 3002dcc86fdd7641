// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/line_process.h"

#include <gmock/gmock.h>

#include "tests/ltm/expect_status.h"

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
  EXPECT_FAILS(process.read_line(20ms), StatusCode::kUnavailable, "said nothing");
}

TEST(LineProcess, SaysWhatIsNotThere) {
  LineProcess process;
  EXPECT_FAILS(process.start({"no-such-program"}), StatusCode::kNotFound, "'no-such-program'");
}

}  // namespace
}  // namespace engram
