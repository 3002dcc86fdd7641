// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_clock.h"

#include <algorithm>
#include <cmath>

namespace engram::memory {

ReplayClock::ReplayClock(Time at, double speed, SteadyClock steady)
    : steady_(std::move(steady)), anchor_(at), anchored_at_(steady_()), speed_(speed) {
  ENGRAM_CHECK(check_replay_speed(speed).ok(), "found a speed of {}", speed);
}

Time ReplayClock::read() const {
  if (!is_playing_) return anchor_;
  const double passed_ns = static_cast<double>((steady_() - anchored_at_).count()) * speed_;
  const double room_ns = static_cast<double>(INT64_MAX) - static_cast<double>(to_ns(anchor_));
  if (passed_ns >= room_ns) return Time::max();
  const Time shown = anchor_ + Duration(static_cast<int64_t>(passed_ns));
  return loop_ && anchor_ <= loop_->last ? std::min(shown, loop_->last) : shown;
}

void ReplayClock::set(Time now) {
  anchor_ = now;
  anchored_at_ = steady_();
}

Time ReplayClock::now() const {
  const MutexLock lock(mutex_);
  return read();
}

ReplayClock::Course ReplayClock::course() const {
  const MutexLock lock(mutex_);
  return {read(), speed_, is_playing_, loop_, jumps_};
}

void ReplayClock::set_playing(bool is_playing) {
  const MutexLock lock(mutex_);
  set(read());
  is_playing_ = is_playing;
}

void ReplayClock::set_speed(double speed) {
  ENGRAM_CHECK(check_replay_speed(speed).ok(), "found a speed of {}", speed);
  const MutexLock lock(mutex_);
  set(read());
  speed_ = speed;
}

void ReplayClock::jump(Time to) {
  const MutexLock lock(mutex_);
  set(to);
  ++jumps_;
}

void ReplayClock::advance(Time to) {
  const MutexLock lock(mutex_);
  set(std::max(to, read()));
}

void ReplayClock::set_loop(std::optional<ReplayLoop> loop) {
  const MutexLock lock(mutex_);
  set(read());
  loop_ = loop;
}

Duration ReplayClock::until(Time time) const {
  const MutexLock lock(mutex_);
  const Time now = read();
  if (now >= time) return Duration(0);
  if (!is_playing_) return Duration::max();
  const double wait_ns =
      (static_cast<double>(to_ns(time)) - static_cast<double>(to_ns(now))) / speed_;
  constexpr double kDay_ns = 86'400e9;
  // Rounded up, so that it shows `time` afterwards.
  return Duration(static_cast<int64_t>(std::ceil(std::min(wait_ns, kDay_ns)))) + Duration(1);
}

}  // namespace engram::memory
