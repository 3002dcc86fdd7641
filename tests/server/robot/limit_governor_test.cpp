// SPDX-License-Identifier: Apache-2.0
#include "server/robot/limit_governor.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

using std::chrono::seconds;

constexpr uint64_t kMiB = uint64_t{1} << 20;
constexpr uint64_t kGiB = uint64_t{1} << 30;

constexpr SteadyTime at(int64_t second) {
  return SteadyTime(seconds(second));
}

HostState with_available(double share) {
  HostState state;
  state.ram = {16 * kGiB, static_cast<uint64_t>(share * static_cast<double>(16 * kGiB))};
  return state;
}

HostState with_pressure(double some) {
  HostState state = with_available(0.5);
  state.memory_pressure = Pressure{some, 0};
  return state;
}

LimitGovernor governor_of(uint64_t configured, uint64_t floor) {
  return *LimitGovernor::create({.configured_bytes = configured, .floor_bytes = floor});
}

TEST(LimitGovernor, LeavesTheLimitWhereNothingIsTight) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  for (int second = 0; second < 1000; ++second)
    EXPECT_FALSE(governor.update(at(second), with_available(0.5), 900 * kMiB));
  EXPECT_EQ(governor.limit().bytes, 1000 * kMiB);
  EXPECT_EQ(governor.limit().reason, "as configured");
}

TEST(LimitGovernor, ShrinksWhatIsTakenStepByStepDownToTheFloor) {
  LimitGovernor governor = governor_of(1000 * kMiB, 300 * kMiB);
  std::vector<uint64_t> limits;
  for (int second = 0; second < 60; ++second)
    if (const auto change =
            governor.update(at(second), with_available(0.05), governor.limit().bytes)) {
      limits.push_back(change->after_bytes / kMiB);
      EXPECT_EQ(second % 3, 0);
    }
  EXPECT_EQ(limits, (std::vector<uint64_t>{700, 489, 342, 300}));
}

TEST(LimitGovernor, ShrinksFromWhatIsTakenRatherThanFromWhatIsAllowed) {
  LimitGovernor governor = governor_of(1000 * kMiB, 10 * kMiB);
  const auto change = governor.update(at(0), with_available(0.05), 200 * kMiB);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->before_bytes, 1000 * kMiB);
  EXPECT_EQ(change->after_bytes, 140 * kMiB);
}

TEST(LimitGovernor, SaysWhyInNumbers) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  EXPECT_EQ(governor.update(at(0), with_available(0.05), 1000 * kMiB)->reason,
            "shrinks: 819 of 16384 MiB of RAM (5 %) are available, below 10 %");
  EXPECT_EQ(governor.update(at(20), with_pressure(40), 700 * kMiB)->reason,
            "shrinks: programs waited for RAM 40 % of the last 10 s, above 10 %");
  EXPECT_EQ(governor.limit().reason,
            "shrinks: programs waited for RAM 40 % of the last 10 s, above 10 %");
}

TEST(LimitGovernor, WaitsForPressureToBeMeasuredAnew) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  int changes = 0;
  for (int second = 0; second < 30; ++second)
    changes += governor.update(at(second), with_pressure(40), governor.limit().bytes) ? 1 : 0;
  EXPECT_EQ(changes, 3);
}

TEST(LimitGovernor, DoesNothingBetweenTheThresholds) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  ASSERT_TRUE(governor.update(at(0), with_available(0.05), 1000 * kMiB));
  for (int second = 1; second < 1000; ++second) {
    EXPECT_FALSE(governor.update(at(second), with_available(0.15), 600 * kMiB));
    EXPECT_FALSE(governor.update(at(second), with_pressure(5), 600 * kMiB));
  }
}

TEST(LimitGovernor, GrowsOnlyAfterItHasBeenCalmForAWhile) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  ASSERT_TRUE(governor.update(at(0), with_available(0.05), 1000 * kMiB));
  for (int second = 1; second < 25; ++second)
    EXPECT_FALSE(governor.update(at(second), with_available(0.5), 700 * kMiB));
  EXPECT_FALSE(governor.update(at(25), with_available(0.15), 700 * kMiB));
  for (int second = 26; second < 56; ++second)
    EXPECT_FALSE(governor.update(at(second), with_available(0.5), 700 * kMiB)) << second;
  const auto change = governor.update(at(56), with_available(0.5), 700 * kMiB);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->after_bytes, change->before_bytes + 50 * kMiB);
  EXPECT_FALSE(governor.update(at(60), with_available(0.5), 750 * kMiB));
  EXPECT_TRUE(governor.update(at(61), with_available(0.5), 750 * kMiB));
}

TEST(LimitGovernor, CountsWhatIsAllowedAndNotTakenYetAsTaken) {
  LimitGovernor governor = governor_of(8 * kGiB, kGiB);
  ASSERT_TRUE(governor.update(at(0), with_available(0.05), 8 * kGiB));
  const uint64_t limit = governor.limit().bytes;
  // 8 GiB are free, 3.2 are to stay so, and nearly all of the limit may still be taken.
  for (int second = 1; second < 100; ++second)
    EXPECT_FALSE(governor.update(at(second), with_available(0.5), limit / 100));
  EXPECT_TRUE(governor.update(at(100), with_available(0.5), limit));
}

TEST(LimitGovernor, LooksAtTheControlGroupWhereThatIsTighter) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  HostState host = with_available(0.9);
  host.group_ram = RamState{kGiB, 50 * kMiB};
  EXPECT_TRUE(governor.update(at(0), host, 900 * kMiB));
}

TEST(LimitGovernor, DoesNothingWhereTheMachineIsNotKnown) {
  LimitGovernor governor = governor_of(1000 * kMiB, 100 * kMiB);
  EXPECT_FALSE(governor.update(at(0), HostState(), 900 * kMiB));
}

TEST(LimitGovernor, RefusesOptionsThatMakeNoSense) {
  using Options = LimitGovernor::Options;
  for (const Options& options :
       {Options{.configured_bytes = 1, .floor_bytes = 2}, Options{.floor_bytes = 0},
        Options{.shrink_below = 0.3}, Options{.shrink_below = 0}, Options{.grow_above = 1},
        Options{.shrink_pressure = 1}, Options{.grow_pressure = -1}, Options{.shrink_factor = 1},
        Options{.shrink_factor = 0}, Options{.grow_share = 0}, Options{.calm = seconds(-1)}})
    EXPECT_FALSE(LimitGovernor::create(options).ok());
}

/// A machine of 16 GiB with servers that fill their memory as far as they may, beside other
/// programs. A second passes at a time.
class Machine {
 public:
  /// Bytes that the other programs take in a second.
  using Others = std::function<uint64_t(int64_t second)>;

  Machine(size_t servers, Others others) : others_(std::move(others)), taken_(servers) {
    for (size_t i = 0; i < servers; ++i) governors_.push_back(governor_of(4 * kGiB, kFloor));
  }

  void run_until(int64_t end, uint64_t filled_each_second = 100 * kMiB) {
    for (; second_ < end; ++second_) {
      for (size_t i = 0; i < governors_.size(); ++i)
        taken_[i] = std::min(taken_[i] + filled_each_second, governors_[i].limit().bytes);
      const HostState host = state();
      min_available_ = std::min(min_available_, host.ram.available_bytes);
      for (size_t i = 0; i < governors_.size(); ++i)
        if (const auto change = governors_[i].update(at(second_), host, taken_[i]))
          note(i, change->after_bytes > change->before_bytes);
    }
  }

  [[nodiscard]] HostState state() const {
    uint64_t used = others_(second_);
    for (const uint64_t taken : taken_) used += taken;
    HostState host;
    host.ram = {kRam, kRam - std::min(kRam, used)};
    return host;
  }

  [[nodiscard]] uint64_t limit(size_t server) const { return governors_[server].limit().bytes; }
  [[nodiscard]] int changes() const { return changes_; }
  /// How often a server shrank after it had grown, or the other way round.
  [[nodiscard]] int turns() const { return turns_; }
  [[nodiscard]] uint64_t min_available() const { return min_available_; }
  void forget_min() { min_available_ = kRam; }

  static constexpr uint64_t kRam = 16 * kGiB;
  static constexpr uint64_t kFloor = 256 * kMiB;

 private:
  void note(size_t server, bool is_growing) {
    ++changes_;
    was_growing_.resize(governors_.size());
    if (was_growing_[server] && *was_growing_[server] != is_growing) ++turns_;
    was_growing_[server] = is_growing;
  }

  Others others_;
  std::vector<LimitGovernor> governors_;
  std::vector<uint64_t> taken_;
  std::vector<std::optional<bool>> was_growing_;
  int64_t second_ = 0;
  int changes_ = 0;
  int turns_ = 0;
  uint64_t min_available_ = kRam;
};

TEST(SimulatedMachine, GetsTightAndRecovers) {
  for (const size_t servers : {1u, 2u}) {
    Machine machine(servers, [](int64_t second) {
      return second >= 200 && second < 600 ? 14 * kGiB + kGiB / 2 : 2 * kGiB;
    });
    machine.run_until(200);
    EXPECT_EQ(machine.changes(), 0) << servers;
    machine.run_until(230);
    machine.forget_min();
    machine.run_until(600);
    EXPECT_GE(machine.limit(0), Machine::kFloor);
    EXPECT_LT(machine.limit(0), kGiB);
    EXPECT_GT(machine.min_available(), kGiB / 2) << "where others take nearly everything";
    machine.run_until(1000);
    for (size_t i = 0; i < servers; ++i) EXPECT_EQ(machine.limit(i), 4 * kGiB) << servers;
    EXPECT_EQ(machine.turns(), static_cast<int>(servers)) << "down once, and up again";
    const int changes = machine.changes();
    machine.run_until(3000);
    EXPECT_EQ(machine.changes(), changes);
  }
}

TEST(SimulatedMachine, IsSharedByServersThatMayTakeMoreThanThereIs) {
  Machine machine(4, [](int64_t) { return 0; });
  machine.run_until(3000);
  machine.forget_min();
  machine.run_until(10'000);
  EXPECT_GE(machine.min_available(), Machine::kRam / 10);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_GT(machine.limit(i), 2 * kGiB);
    EXPECT_LT(machine.limit(i), 4 * kGiB);
  }
}

TEST(SimulatedMachine, ComesToRestWhereThereIsNeverEnough) {
  for (const uint64_t filled : {5 * kMiB, 50 * kMiB, 5000 * kMiB})
    for (const size_t servers : {1u, 3u, 6u}) {
      Machine machine(servers, [](int64_t) { return 11 * kGiB; });
      machine.run_until(3000, filled);
      const int before = machine.changes();
      machine.forget_min();
      machine.run_until(10'000, filled);
      EXPECT_EQ(machine.changes(), before) << filled << " " << servers;
      EXPECT_EQ(machine.turns(), 0) << filled << " " << servers;
      EXPECT_GE(machine.min_available(), Machine::kRam / 10) << filled << " " << servers;
    }
}

TEST(SimulatedMachine, FollowsOthersThatComeAndGoWithoutSwinging) {
  // Every 200 s somebody takes 6 GiB for 20 s.
  Machine machine(2, [](int64_t second) { return second % 200 < 20 ? 12 * kGiB : 6 * kGiB; });
  machine.run_until(4000);
  EXPECT_LE(machine.turns(), 2 * 2 * 20) << "down once and up once for each visit";
  EXPECT_GE(machine.limit(0), Machine::kFloor);
}

TEST(SimulatedMachine, DecidesTheSameEachTime) {
  const auto run = [] {
    Machine machine(3, [](int64_t second) {
      return 9 * kGiB + static_cast<uint64_t>(second % 37) * 100 * kMiB;
    });
    machine.run_until(2000);
    return std::vector{machine.limit(0), machine.limit(1), machine.limit(2)};
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace engram::server
