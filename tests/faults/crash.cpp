// SPDX-License-Identifier: Apache-2.0
// crash KILLS [SEED]: runs sessions, kills each at a random moment (SIGKILL), and looks whether
// every acknowledged snapshot is there, as the dead process left it and once a new writer took
// over. Prints a table; exit code 1 where anything is missing.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstring>
#include <random>
#include <string_view>
#include <thread>

#include "ltm/core/log.h"
#include "tests/faults/verify.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm::faults {
namespace {

/// Kills before a new store is begun, so that stores stay small and young ones are met as well.
constexpr int kKillsPerStore = 10;
constexpr int kLongestRun_us = 80'000;

struct Row {
  int kills = 0;
  int failures = 0;
};

struct Table {
  std::array<Row, kSteps> rows;
  uint64_t acknowledged = 0;
  uint64_t checked = 0;
  int finished = 0;  ///< Sessions that ended before they were killed.
};

[[noreturn]] void run_forever(const std::filesystem::path& store, const SessionOptions& options,
                              int pipe) {
  log::set_level(log::Level::kOff);
  const Tell tell = [pipe](const Told& told) {
    if (::write(pipe, &told, sizeof(told)) != sizeof(told)) ::_exit(5);
  };
  run_session(store, options, tell);
  ::_exit(0);
}

/// Runs one session and kills it `run` after it has begun. Returns whether it was killed.
bool run_and_kill(const std::filesystem::path& store, const SessionOptions& options,
                  std::chrono::microseconds run, std::vector<Told>& told) {
  int ends[2] = {-1, -1};
  ENGRAM_CHECK(::pipe(ends) == 0, "no pipe");
  const pid_t child = ::fork();
  ENGRAM_CHECK(child >= 0, "no process");
  if (child == 0) {
    ::close(ends[0]);
    run_forever(store, options, ends[1]);
  }
  ::close(ends[1]);
  Told each;
  const auto read_one = [&] { return ::read(ends[0], &each, sizeof(each)) == sizeof(each); };
  if (read_one()) told.push_back(each);
  std::jthread killer([child, run] {
    std::this_thread::sleep_for(run);
    ::kill(child, SIGKILL);
  });
  while (read_one()) told.push_back(each);
  killer.join();
  int status = 0;
  ENGRAM_CHECK(::waitpid(child, &status, 0) == child, "the child is gone");
  ::close(ends[0]);
  ENGRAM_CHECK(WIFSIGNALED(status) ? WTERMSIG(status) == SIGKILL : WEXITSTATUS(status) == 0,
               "a session ended with status {}", status);
  return WIFSIGNALED(status);
}

int step_of(const std::vector<Told>& told) {
  for (auto each = told.rbegin(); each != told.rend(); ++each)
    if (each->kind == Told::kStep) return each->number;
  return 0;
}

int64_t next_index(const std::vector<Told>& told, int64_t first) {
  // One that was under way may be stored without being acknowledged: leave its place to it.
  for (const Told& each : told)
    if (each.kind == Told::kStored) first = std::max(first, each.index + 2);
  return first;
}

void report(const std::vector<std::string>& problems, int kill, const char* step) {
  for (const std::string& problem : problems)
    fmt::print(stderr, "kill {} (while: {}): {}\n", kill, step, problem);
}

Table run(int kills, uint32_t seed) {
  Table table;
  std::mt19937 random(seed);
  for (int kill = 0; kill < kills;) {
    const ScratchDirectory scratch;
    std::vector<Told> told;
    for (int k = 0; k < kKillsPerStore && kill < kills; ++k, ++kill) {
      SessionOptions options{.pause_us = 200,
                             .first = next_index(told, 0),
                             .rounds = 1000,
                             .consolidate_every = 1 + static_cast<int>(random() % 5)};
      options.store = {.durability = random() % 2 == 0 ? Durability::kNone : Durability::kEvery,
                       .seal_bytes = 1000 + random() % 20'000,
                       .min_free_bytes = 0};
      const std::chrono::microseconds time(random() % kLongestRun_us);
      const size_t before = told.size();
      if (!run_and_kill(scratch / "store", options, time, told)) ++table.finished;
      for (size_t i = before; i < told.size(); ++i) {
        ENGRAM_CHECK(told[i].kind != Told::kFailed, "a session failed, code {}", told[i].number);
        table.acknowledged += told[i].kind == Told::kStored ? 1 : 0;
      }
      const int step = step_of(told);
      const auto problems = problems_of(scratch / "store", told);
      table.checked +=
          2 * static_cast<uint64_t>(std::ranges::count(told, Told::kStored, &Told::kind));
      report(problems, kill, step_name(step));
      Row& row = table.rows[static_cast<size_t>(step)];
      ++row.kills;
      row.failures += problems.empty() ? 0 : 1;
    }
  }
  return table;
}

int print(const Table& table, int kills, double seconds) {
  int failures = 0;
  fmt::print("{:<16} {:>6} {:>14}\n", "killed while", "kills", "lost anything");
  for (int step = 0; step < kSteps; ++step) {
    const Row& row = table.rows[static_cast<size_t>(step)];
    fmt::print("{:<16} {:>6} {:>14}\n", step_name(step), row.kills, row.failures);
    failures += row.failures;
  }
  fmt::print("{:<16} {:>6} {:>14}\n", "all", kills, failures);
  fmt::print("{} snapshots acknowledged, {} looked for and found whole, {:.0f} s\n",
             table.acknowledged, failures == 0 ? table.checked : 0, seconds);
  return failures == 0 ? 0 : 1;
}

int main_of(int count, char** arguments) {
  const auto number = [&](int at, int fallback) {
    int value = fallback;
    const std::string_view text = at < count ? arguments[at] : "";
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  };
  const int kills = number(1, 300);
  log::set_level(log::Level::kError);
  const auto start = std::chrono::steady_clock::now();
  const Table table = run(kills, static_cast<uint32_t>(number(2, 1)));
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  return print(table, kills, time.count());
}

}  // namespace
}  // namespace engram::ltm::faults

int main(int count, char** arguments) {
  return engram::ltm::faults::main_of(count, arguments);
}
