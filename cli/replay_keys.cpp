// SPDX-License-Identifier: Apache-2.0
#include "cli/replay_keys.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace engram::cli {

namespace {

constexpr Duration kJump = std::chrono::seconds(5);
/// How often a stop is looked for. Unit: ms.
constexpr int kPoll_ms = 100;

struct KeyName {
  std::string_view bytes;
  ReplayKey key;
};

/// An arrow is ESC [ or, in the mode of applications, ESC O, and a letter.
constexpr std::array kKeys{
    KeyName{" ", ReplayKey::kPauseOrPlay},  KeyName{"\033[D", ReplayKey::kBack},
    KeyName{"\033OD", ReplayKey::kBack},    KeyName{"\033[C", ReplayKey::kForward},
    KeyName{"\033OC", ReplayKey::kForward}, KeyName{"+", ReplayKey::kFaster},
    KeyName{"-", ReplayKey::kSlower},       KeyName{"q", ReplayKey::kEnd}};

/// Of the text that a terminal sends for one key: its length, 0 if more has to come.
size_t length_of_key(std::string_view bytes) {
  if (bytes[0] != '\033') return 1;
  if (bytes.size() > 1 && bytes[1] != '[' && bytes[1] != 'O') return 1;
  if (bytes.size() < 3) return 0;
  if (bytes[1] == 'O') return 3;
  const auto end = std::find_if(bytes.begin() + 2, bytes.end(),
                                [](char one) { return one >= '@' && one <= '~'; });
  return end == bytes.end() ? 0 : static_cast<size_t>(end - bytes.begin()) + 1;
}

/// Lets a terminal give each key at once, and restores it.
class EachKey {
 public:
  explicit EachKey(int terminal) : terminal_(terminal) {
    is_known_ = ::tcgetattr(terminal_, &before_) == 0;
    set();
  }
  EachKey(const EachKey&) = delete;
  EachKey& operator=(const EachKey&) = delete;
  ~EachKey() { restore(); }

  void restore() const {
    if (is_known_) ::tcsetattr(terminal_, TCSANOW, &before_);
  }

  /// Again after a shell had the terminal, which sets it as it likes it. Ctrl-C goes on to
  /// interrupt.
  void set() const {
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    now.c_cc[VMIN] = 1;
    now.c_cc[VTIME] = 0;
    if (is_known_) ::tcsetattr(terminal_, TCSANOW, &now);
  }

 private:
  const int terminal_;
  termios before_{};
  bool is_known_ = false;
};

/// Waits a moment, and reads what was typed if it `may_read`. Nothing at the end of input.
std::optional<std::string> typed(int terminal, bool may_read) {
  pollfd waits{terminal, POLLIN, 0};
  if (::poll(&waits, may_read ? 1 : 0, kPoll_ms) <= 0) return std::string();
  std::array<char, 64> bytes{};
  const ssize_t count = ::read(terminal, bytes.data(), bytes.size());
  if (count <= 0) return std::nullopt;
  return std::string(bytes.data(), static_cast<size_t>(count));
}

ReplayCommand command_of_key(ReplayKey key, const ReplayState& now) {
  using Kind = ReplayCommand::Kind;
  switch (key) {
    case ReplayKey::kBack:
      return {.kind = Kind::kSeek, .time = std::max(now.now - kJump, now.first)};
    case ReplayKey::kForward:
      return {.kind = Kind::kSeek, .time = now.now + kJump};
    case ReplayKey::kFaster:
      return {.kind = Kind::kSpeed, .speed = std::min(now.speed * 2, kMaxReplaySpeed)};
    case ReplayKey::kSlower:
      return {.kind = Kind::kSpeed, .speed = std::max(now.speed / 2, kMinReplaySpeed)};
    default:
      return {.kind = now.is_playing ? Kind::kPause : Kind::kPlay};
  }
}

}  // namespace

std::vector<ReplayKey> take_keys(std::string& bytes) {
  std::vector<ReplayKey> keys;
  std::string_view rest = bytes;
  while (!rest.empty()) {
    const size_t length = length_of_key(rest);
    if (length == 0) break;
    const std::string_view one = rest.substr(0, length);
    const auto* const known = std::ranges::find(kKeys, one, &KeyName::bytes);
    if (known != kKeys.end()) keys.push_back(known->key);
    rest.remove_prefix(length);
  }
  bytes.erase(0, bytes.size() - rest.size());
  return keys;
}

Status press(ReplayKey key, memory::Replay& replay) {
  return replay.obey(command_of_key(key, replay.state()));
}

bool has_keys(int file) {
  return ::isatty(file) != 0 && ::tcgetpgrp(file) == ::getpgrp();
}

bool control_by_keys(int terminal, memory::Replay& replay, const std::stop_token& stop,
                     const std::function<void(const std::string&)>& tell) {
  const EachKey each(terminal);
  // At once, as a second Ctrl-C ends the program without any destructor.
  const std::stop_callback restoring(stop, [&each] { each.restore(); });
  std::string bytes;
  bool was_in_front = true;
  while (!stop.stop_requested()) {
    const bool is_in_front = has_keys(terminal);
    if (is_in_front && !was_in_front) each.set();
    was_in_front = is_in_front;
    // The system would stop who reads behind another program.
    const auto more = typed(terminal, is_in_front);
    if (!more) return false;
    bytes += *more;
    for (const ReplayKey key : take_keys(bytes)) {
      if (key == ReplayKey::kEnd) return true;
      const Status done = press(key, replay);
      tell(done.ok() ? state_text(replay.state()) : std::string(done.message()));
    }
  }
  return false;
}

std::string state_text(const ReplayState& state) {
  return fmt::format("{}, {} at speed {}{}", to_string(state.now),
                     state.is_playing ? "plays" : "pauses", state.speed,
                     state.loop ? fmt::format(", repeats {}..{}", to_string(state.loop->first),
                                              to_string(state.loop->last))
                                : "");
}

}  // namespace engram::cli
