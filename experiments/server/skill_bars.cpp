// SPDX-License-Identifier: Apache-2.0
// Measures how soon a skill starts after the event that its condition waits for: from before the
// commit of the event to the first line of the skill's function. Server, provider and the program
// that commits are processes of their own. Beside it: the bare way of such an event to a
// subscriber, and of a commit that survives a killed server, because each start is one.
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "ltm/core/log.h"
#include "server/client/skill_provider.h"
#include "server/robot/robot.h"

namespace engram::experiments {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

struct Arguments {
  int events = 10'000;
  int conditions = 100;
  int pause_us = 2000;
  std::string json;
};

[[noreturn]] void die(const Status& status) {
  std::cerr << "skill_bars: " << status.to_string() << "\n";
  std::exit(1);
}

template <typename T>
T value_or_die(Result<T> result) {
  if (!result.ok()) die(result.status());
  return *std::move(result);
}

/// Nanoseconds of a clock that all processes share.
int64_t now_ns() {
  return std::chrono::duration_cast<Duration>(steady_now().time_since_epoch()).count();
}

/// A child that runs `role`, and is killed when this is destroyed.
class Child {
 public:
  template <typename Role>
  explicit Child(const Role& role) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    role();
    ::_exit(0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

 private:
  const pid_t pid_;
};

/// Numbers from a child to its parent.
struct Pipe {
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) die(unavailable("no pipe"));
  }
  void write(int64_t number) const {
    if (::write(ends[1], &number, sizeof(number)) != sizeof(number)) std::exit(1);
  }
  [[nodiscard]] int64_t read() const {
    int64_t number = 0;
    if (::read(ends[0], &number, sizeof(number)) != sizeof(number))
      die(unavailable("a process ended"));
    return number;
  }
  std::array<int, 2> ends{};
};

ltm::MemoryId lamp(int index) {
  return value_or_die(ltm::MemoryId::parse(fmt::format("World/Things/room/lamp_{}", index)));
}

void serve(const std::filesystem::path& folder) {
  const auto config = value_or_die(server::parse_robot_config(
      fmt::format("servers: [{{name: s, listen: 'unix:{0}/s', store: {0}/robot.engram}}]",
                  folder.string()),
      "robot.yaml", folder));
  const auto robot = value_or_die(server::Robot::start(config));
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

void provide(const std::string& endpoint, int conditions, const Pipe& started) {
  const auto provider = value_or_die(SkillProvider::connect(endpoint, "bench"));
  for (int i = 0; i < conditions; ++i) {
    const Status added = provider->add(
        fmt::format("name: lamp_{0}\nmax_running: 1000\n"
                    "conditions: {{when: {{entity: 'World/Things/.*/lamp_{0}', path: on, "
                    "equals: true, new: true}}}}\n",
                    i),
        [&](SkillRun&) {
          started.write(now_ns());
          return SkillEnd::success();
        });
    if (!added.ok()) die(added);
  }
  started.write(0);
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

json summary(std::vector<double> ms) {
  std::ranges::sort(ms);
  const auto at = [&](double share) {
    return ms.at(
        std::min(ms.size() - 1, static_cast<size_t>(share * static_cast<double>(ms.size()))));
  };
  return {{"p50_ms", at(0.5)}, {"p90_ms", at(0.9)}, {"p99_ms", at(0.99)}, {"max_ms", ms.back()}};
}

/// Time of each event until what follows from it.
template <typename Wait>
std::vector<double> measure(Memory& memory, const Arguments& arguments, CommitDurability durability,
                            const Wait& wait) {
  std::vector<double> ms;
  for (int i = 0; i < arguments.events; ++i) {
    const int64_t begin = now_ns();
    const Status committed = memory.commit(
        {{{lamp(i % arguments.conditions), system_now(), {{idf::Dict{{"on", true}}, {}}}}}},
        durability);
    if (!committed.ok()) die(committed);
    ms.push_back(static_cast<double>(wait() - begin) / 1e6);
    std::this_thread::sleep_for(std::chrono::microseconds(arguments.pause_us));
  }
  return ms;
}

int run(const Arguments& arguments) {
  std::string name = (std::filesystem::temp_directory_path() / "skill-bars-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) die(unavailable("no folder"));
  const std::filesystem::path folder = name;
  const std::string endpoint = fmt::format("unix:{}/s", name);
  json report;
  {
    // Children begin before this process has threads.
    const Pipe started;
    const Child server([&] { serve(folder); });
    const Child provider([&] { provide(endpoint, arguments.conditions, started); });
    const auto memory = value_or_die(Memory::connect(endpoint));
    static_cast<void>(started.read());
    report["event_to_start"] = summary(
        measure(*memory, arguments, CommitDurability::kMemory, [&] { return started.read(); }));
    report["commit_to_journal"] = summary(measure(*memory,
                                                  {.events = std::min(arguments.events, 1000),
                                                   .conditions = arguments.conditions,
                                                   .pause_us = arguments.pause_us},
                                                  CommitDurability::kJournal, [&] {
                                                    const int64_t now = now_ns();
                                                    static_cast<void>(started.read());
                                                    return now;
                                                  }));
    const auto figures = value_or_die(memory->query("Skill/Event @ all"));
    size_t events = 0;
    for (const ltm::EntityResult* entity : figures.entities()) events += entity->snapshots.size();
    report["events_kept"] = events;
    report["conditions"] = arguments.conditions;
    report["events"] = arguments.events;
  }
  std::filesystem::remove_all(folder);
  std::cout << report.dump(1) << "\n";
  const json& measured = report["event_to_start"];
  fmt::print("event to start: p50 {:.2f} ms (bar 2), p99 {:.2f} ms (bar 10)\n",
             measured["p50_ms"].get<double>(), measured["p99_ms"].get<double>());
  if (!arguments.json.empty()) std::ofstream(arguments.json) << report.dump(1) << "\n";
  return 0;
}

}  // namespace
}  // namespace engram::experiments

int main(int argc, char** argv) {
  engram::log::set_level(engram::log::Level::kError);
  engram::experiments::Arguments arguments;
  CLI::App app("How soon does a skill start after the event that its condition waits for?");
  app.add_option("--events", arguments.events)->check(CLI::Range(1, 1'000'000));
  app.add_option("--conditions", arguments.conditions)->check(CLI::Range(1, 1000));
  app.add_option("--pause-us", arguments.pause_us, "Between two events");
  app.add_option("--json", arguments.json, "Writes the figures to this file");
  CLI11_PARSE(app, argc, argv);
  return engram::experiments::run(arguments);
}
