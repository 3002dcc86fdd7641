// SPDX-License-Identifier: Apache-2.0
// A robot whose providers of skills and whose server are killed at random moments: each execution
// has one start and one end, none is carried out twice, each request that was acknowledged has an
// answer, and every link leads to something.
//
//     skill_kills KILLS [SEED]
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "ltm/core/file.h"
#include "ltm/core/log.h"
#include "ltm/skills/skill_ids.h"
#include "ltm/skills/skill_types.h"
#include "server/client/skill_provider.h"
#include "server/robot/robot.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/soak/soak_processes.h"

namespace engram::soak {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr int kProviders = 2;
constexpr int kAskers = 2;

std::string endpoint_in(const std::filesystem::path& folder) {
  return fmt::format("unix:{}/s", folder.string());
}

/// Appends a line in one write, so that a kill leaves it whole or not there.
void note_line(const std::filesystem::path& file, const std::string& text) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const std::string line = text + "\n";
  ENGRAM_CHECK(descriptor >= 0 && ::write(descriptor, line.data(), line.size()) ==
                                      static_cast<ssize_t>(line.size()),
               "cannot write '{}'", file.string());
  ::close(descriptor);
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

[[noreturn]] void sleep_for_ever() {
  while (true) std::this_thread::sleep_for(seconds(1));
}

int run_skill_server(const std::filesystem::path& folder) {
  const auto config = server::parse_robot_config(
      fmt::format("servers: [{{name: s, listen: '{}', store: {}/robot.engram}}]",
                  endpoint_in(folder), folder.string()),
      "robot.yaml", folder);
  if (!config.ok()) return 1;
  const auto robot = server::Robot::start(*config);
  if (!robot.ok()) {
    fmt::print(stderr, "{}\n", robot.status().message());
    return 1;
  }
  sleep_for_ever();
}

int run_provider(const std::filesystem::path& folder, const std::string& name) {
  const auto provider = SkillProvider::connect(endpoint_in(folder), name, {.timeout = seconds(60)});
  if (!provider.ok()) return 1;
  const Status added = (*provider)->add(
      "name: work\nmax_running: 4\nparameters: {ms: {type: int, default: 5}}\n"
      "conditions: {when: {entity: World/Things/.*/lamp, path: on, equals: true}}\n",
      [&](SkillRun& run) {
        note_line(folder / "carried_out", run.execution().to_string());
        const auto ms = run.parameters().at("ms")->as_number().value_or(0);
        const Status reported = run.report(idf::Dict{{"ms", ms}}, {run.request()});
        std::this_thread::sleep_for(milliseconds(static_cast<int>(ms)));
        return reported.ok() ? SkillEnd::success("worked") : SkillEnd::failure("not heard");
      });
  if (!added.ok()) return 1;
  sleep_for_ever();
}

/// Asks for skills, and switches a lamp that starts one.
int run_asker(const std::filesystem::path& folder, const std::string& name, int start) {
  auto memory = Memory::connect(endpoint_in(folder), {.timeout = seconds(2)});
  if (!memory.ok()) return 1;
  std::mt19937 random(static_cast<unsigned>(start) * 7U + (name == "0" ? 1U : 2U));
  const auto lamp = *ltm::MemoryId::parse("World/Things/" + name + "/lamp");
  for (bool is_on = false;; is_on = !is_on) {
    ::skill::ExecutionRequest request;
    request.skill = fmt::format("p{}/work", random() % kProviders);
    request.parameters = fmt::format(R"({{"ms": {}}})", random() % 30);
    request.wait = random() % 3 == 0 ? 0.5 : 0;
    const Time now = system_now();
    const ltm::MemoryId entity = skills::request_id("asker" + name, "work");
    ltm::Commit commit{{{entity, now, {{request.to_idf(), {}}}}}};
    commit.updates.push_back({lamp, now, {{idf::Dict{{"on", is_on}}, {}}}});
    if ((*memory)->commit(commit, CommitDurability::kJournal).ok())
      note_line(folder / "acknowledged", entity.at(now).instance(0).to_string());
    std::this_thread::sleep_for(milliseconds(random() % 20));
  }
}

struct Executions {
  int starts = 0;
  int ends = 0;
};

/// What is wrong with what the server has and what was noted; empty if nothing is.
std::vector<std::string> check_robot(const std::filesystem::path& folder,
                                     std::map<std::string, int>& counts) {
  std::vector<std::string> wrong;
  const auto memory = Memory::connect(endpoint_in(folder), {.timeout = seconds(30)});
  if (!memory.ok()) return {memory.status().to_string()};
  std::map<std::string, Executions> executions;
  std::set<std::string> answered;
  std::set<std::string> links;
  const auto each = [&](const char* segment, const auto& visit) {
    const auto answer = (*memory)->query(fmt::format("Skill/{} @ all", segment));
    if (!answer.ok()) return wrong.push_back(answer.status().to_string());
    for (const ltm::EntityResult* entity : answer->entities())
      for (const ltm::SnapshotResult& one : entity->snapshots)
        visit(entity->id.at(one.time).instance(0), one.instances.front().data);
  };
  each("Event", [&](const ltm::MemoryId& id, const idf::Data& data) {
    const auto event = ::skill::Event::from_idf(data);
    if (!event.ok()) return wrong.push_back(event.status().to_string());
    const bool is_start = event->stage == ::skill::Stage::STARTED;
    Executions& one =
        executions[is_start ? id.to_string() : event->execution.value_or(id).to_string()];
    one.starts += is_start ? 1 : 0;
    if (event->stage == ::skill::Stage::ENDED) {
      ++one.ends;
      ++counts[event->outcome == ::skill::Outcome::LOST ? "lost" : "ended otherwise"];
    }
    answered.insert(event->request.to_string());
    links.insert(event->request.to_string());
    links.insert(event->executable.to_string());
    if (event->execution) links.insert(event->execution->to_string());
    for (const ltm::MemoryId& link : event->results) links.insert(link.to_string());
  });
  each("Refusal", [&](const ltm::MemoryId& /*id*/, const idf::Data& data) {
    const auto refusal = ::skill::Refusal::from_idf(data);
    if (!refusal.ok()) return wrong.push_back(refusal.status().to_string());
    ++counts["refused"];
    answered.insert(refusal->request.to_string());
    links.insert(refusal->request.to_string());
    if (refusal->executable) links.insert(refusal->executable->to_string());
  });
  each("ExecutionRequest", [&](const ltm::MemoryId& /*id*/, const idf::Data& data) {
    const auto request = ::skill::ExecutionRequest::from_idf(data);
    if (!request.ok()) return wrong.push_back(request.status().to_string());
    for (const ltm::MemoryId& link : request->causes) links.insert(link.to_string());
  });
  for (const auto& [execution, one] : executions)
    if (one.starts != 1 || one.ends != 1)
      wrong.push_back(fmt::format("{}: {} starts and {} ends", execution, one.starts, one.ends));
  std::map<std::string, int> carried_out;
  for (const std::string& line : lines_of(folder / "carried_out")) ++carried_out[line];
  for (const auto& [execution, times] : carried_out) {
    if (times != 1) wrong.push_back(fmt::format("{}: carried out {} times", execution, times));
    if (!executions.contains(execution))
      wrong.push_back(fmt::format("{}: carried out without a start", execution));
  }
  for (const std::string& request : lines_of(folder / "acknowledged"))
    if (!answered.contains(request)) wrong.push_back(request + ": has no answer");
  for (const std::string& link : links) {
    const ltm::MemoryId id = *ltm::MemoryId::parse(link);
    const auto found =
        (*memory)->query(ltm::Query::of_entity(id.entity(), ltm::select::At{*id.time()}), "");
    if (!found.ok() || found->find_instance(id) == nullptr)
      wrong.push_back(link + ": is linked to, and not there");
  }
  counts["executions"] = static_cast<int>(executions.size());
  counts["carried out"] = static_cast<int>(carried_out.size());
  counts["links"] = static_cast<int>(links.size());
  return wrong;
}

int kill_all(int kills, unsigned seed) {
  const ScratchDirectory folder;
  std::vector<Process> processes;
  processes.push_back(Process({"server", folder.path().string()}));
  for (int i = 0; i < kProviders; ++i)
    processes.push_back(Process({"provider", folder.path().string(), fmt::format("p{}", i)}));
  for (int i = 0; i < kAskers; ++i)
    processes.push_back(Process({"asker", folder.path().string(), std::to_string(i)}));
  for (Process& one : processes) one.start();
  std::mt19937 random(seed);
  std::map<std::string, int> counts;
  // The first moments are those of connecting, which are killed in, too.
  std::this_thread::sleep_for(seconds(1));
  for (int i = 0; i < kills; ++i) {
    std::this_thread::sleep_for(milliseconds(random() % 500));
    Process& one = processes[random() % (1 + kProviders)];
    ++counts["kills of " + one.words().front()];
    one.kill();
    std::this_thread::sleep_for(milliseconds(random() % 100));
    one.start();
    for (Process& other : processes)
      if (other.has_ended()) other.start();
    if ((i + 1) % 100 == 0) fmt::print("{} kills\n", i + 1);
  }
  std::this_thread::sleep_for(seconds(2));
  for (size_t i = processes.size(); i-- > 0;) processes[i].kill();
  // What ran at the last kill ends when the memory is opened again.
  Process& server = processes.front();
  server.start();
  const auto wrong = check_robot(folder.path(), counts);
  for (const auto& [what, count] : counts) fmt::print("{}: {}\n", what, count);
  for (size_t i = 0; i < wrong.size() && i < 20; ++i) fmt::print("wrong: {}\n", wrong[i]);
  const bool is_enough = counts["carried out"] > kills;
  if (!is_enough) fmt::print("wrong: too little was carried out to tell\n");
  return wrong.empty() && is_enough ? 0 : 1;
}

}  // namespace

int skill_kills_main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() >= 3 && words[0] == "server") return run_skill_server(words[1]);
  if (words.size() >= 4 && words[0] == "provider") return run_provider(words[1], words[2]);
  if (words.size() >= 4 && words[0] == "asker")
    return run_asker(words[1], words[2], std::stoi(words[3]));
  if (words.empty()) {
    fmt::print("skill_kills KILLS [SEED]\n");
    return 2;
  }
  return kill_all(std::stoi(words[0]),
                  words.size() > 1 ? static_cast<unsigned>(std::stoul(words[1])) : 1U);
}

}  // namespace engram::soak

int main(int argc, char** argv) {
  engram::log::set_level(engram::log::Level::kError);
  return engram::soak::skill_kills_main(argc, argv);
}
