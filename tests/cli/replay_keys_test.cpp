// SPDX-License-Identifier: Apache-2.0
#include "cli/replay_keys.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <future>

#include "tests/memory/replay/lived_memory.h"

namespace engram::cli {
namespace {

using engram::testing::lived_at;
using engram::testing::LivedMemory;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Key = ReplayKey;

TEST(ReplayKeys, AreTakenOnceAllOfThemHasCome) {
  std::string bytes = " +x-\033[C\033OD\033[1;5C\033q";
  EXPECT_THAT(take_keys(bytes), ElementsAre(Key::kPauseOrPlay, Key::kFaster, Key::kSlower,
                                            Key::kForward, Key::kBack, Key::kEnd));
  EXPECT_EQ(bytes, "");
  bytes = "\033";
  EXPECT_THAT(take_keys(bytes), IsEmpty());
  bytes += "[";
  EXPECT_THAT(take_keys(bytes), IsEmpty());
  bytes += "D ";
  EXPECT_THAT(take_keys(bytes), ElementsAre(Key::kBack, Key::kPauseOrPlay));
}

class ReplayKeysTest : public ::testing::Test {
 protected:
  ReplayKeysTest() {
    lived_.live(12);
    lived_.end();
    replay_ = *memory::Replay::open({lived_.path}, nullptr, {.at = lived_at(3), .is_paused = true});
    EXPECT_EQ(::openpty(&keyboard_, &terminal_, nullptr, nullptr, nullptr), 0);
  }
  ~ReplayKeysTest() override {
    ::close(keyboard_);
    ::close(terminal_);
  }

  [[nodiscard]] bool is_raw() const {
    termios now{};
    ::tcgetattr(terminal_, &now);
    return (now.c_lflag & (ICANON | ECHO)) == 0;
  }

  LivedMemory lived_;
  std::shared_ptr<memory::Replay> replay_;
  int keyboard_ = -1, terminal_ = -1;
};

TEST_F(ReplayKeysTest, DoWhatTheySay) {
  const auto state = [this] { return replay_->state(); };
  ASSERT_OK(press(Key::kForward, *replay_));
  EXPECT_EQ(state().now, lived_at(8));
  ASSERT_OK(press(Key::kBack, *replay_));
  EXPECT_EQ(state().now, lived_at(3));
  ASSERT_OK(press(Key::kBack, *replay_));
  EXPECT_EQ(state().now, state().first);
  ASSERT_OK(press(Key::kFaster, *replay_));
  EXPECT_EQ(state().speed, 2);
  for (int i = 0; i < 30; ++i) ASSERT_OK(press(Key::kFaster, *replay_));
  EXPECT_EQ(state().speed, kMaxReplaySpeed);
  for (int i = 0; i < 30; ++i) ASSERT_OK(press(Key::kSlower, *replay_));
  EXPECT_EQ(state().speed, kMinReplaySpeed);
  ASSERT_OK(press(Key::kPauseOrPlay, *replay_));
  EXPECT_TRUE(state().is_playing);
  ASSERT_OK(press(Key::kPauseOrPlay, *replay_));
  EXPECT_FALSE(state().is_playing);
}

/// The terminal of the test is not that of its session, so nothing is read from it.
TEST_F(ReplayKeysTest, LeaveTheTerminalAsItWas) {
  EXPECT_FALSE(has_keys(terminal_));
  ASSERT_FALSE(is_raw());
  std::stop_source stop;
  auto ended = std::async(std::launch::async, [&] {
    return control_by_keys(terminal_, *replay_, stop.get_token(), [](const std::string&) {});
  });
  while (!is_raw()) std::this_thread::yield();
  stop.request_stop();
  EXPECT_FALSE(is_raw());
  EXPECT_FALSE(ended.get());
  EXPECT_FALSE(is_raw());
}

/// In a process that leads a session of the terminal, as under a shell.
TEST(ReplayKeys, AreReadFromTheTerminalInFront) {
  LivedMemory lived;
  lived.live(12);
  lived.end();
  int keyboard = -1;
  const pid_t child = ::forkpty(&keyboard, nullptr, nullptr, nullptr);
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto replay =
        memory::Replay::open({lived.path}, nullptr, {.at = lived_at(3), .is_paused = true});
    const bool was_ended = has_keys(STDIN_FILENO) &&
                           control_by_keys(STDIN_FILENO, **replay, {}, [](const std::string& done) {
                             std::fputs((done + "\n").c_str(), stdout);
                             std::fflush(stdout);
                           });
    termios now{};
    ::tcgetattr(STDIN_FILENO, &now);
    const bool is_restored = (now.c_lflag & ICANON) != 0;
    ::_exit(was_ended && is_restored && (*replay)->state().now == lived_at(8) ? 0 : 1);
  }
  ASSERT_EQ(::write(keyboard, "\033[C+q", 5), 5);
  std::string told;
  char bytes[256];
  for (ssize_t count; (count = ::read(keyboard, bytes, sizeof(bytes))) > 0;)
    told.append(bytes, static_cast<size_t>(count));
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << told;
  EXPECT_THAT(told, ::testing::HasSubstr("pauses at speed 2"));
  ::close(keyboard);
}

}  // namespace
}  // namespace engram::cli
