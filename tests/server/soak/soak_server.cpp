// SPDX-License-Identifier: Apache-2.0
// A robot of several processes, of which any is killed at any moment: nothing that was acknowledged
// as durable is lost, nothing that is answered is wrong, and nothing is left behind.
//
//     soak_server SECONDS [SEED]
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "ltm/core/time.h"
#include "ltm/store/store_reader.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/soak/soak_ledger.h"
#include "tests/server/soak/soak_processes.h"
#include "tests/server/soak/soak_roles.h"

namespace engram::soak {
namespace {

using std::chrono::milliseconds;

/// Of one server; its memory is limited to 8 MiB, what may wait to 32. Sanitizers take their share.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr size_t kMaxResidentBytes = size_t{1500} << 20;
#else
constexpr size_t kMaxResidentBytes = size_t{400} << 20;
#endif

/// All processes but this one.
struct Robot {
  explicit Robot(const std::filesystem::path& folder) {
    const std::string in = folder.string();
    names.push_back(Process({"names", in}));
    for (int i = 0; i < kServers; ++i) servers.push_back(Process({"memory", in, memory_name(i)}));
    for (int i = 0; i < kWriters; ++i)
      clients.push_back(Process({"writer", in, std::to_string(i)}));
    for (int i = 0; i < kReaders; ++i)
      clients.push_back(Process({"reader", in, std::to_string(i)}));
  }

  std::vector<Process*> all() {
    std::vector<Process*> every;
    for (auto* some : {&names, &servers, &clients})
      for (Process& one : *some) every.push_back(&one);
    return every;
  }

  std::vector<Process> names;
  std::vector<Process> servers;
  std::vector<Process> clients;
};

struct Counts {
  std::map<std::string, int> killed;
  int ended_by_themselves = 0;
  int ended_badly = 0;
  size_t max_resident_bytes = 0;
  uint64_t acknowledged = 0;
  uint64_t lost = 0;
  std::map<int64_t, uint64_t> read;  ///< By ReaderCount.
};

std::set<std::string> shared_memory() {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
    const std::string name = entry.path().filename();
    // Other tests that run just now have their folders there.
    if (name.find("engram") != std::string::npos && !name.starts_with("engram-test-"))
      names.insert(name);
  }
  return names;
}

/// Kills and starts again, one after the other, until the time is over.
void make_trouble(Robot& robot, Duration length, std::mt19937& random, Counts& counts) {
  const SteadyTime end = steady_now() + length;
  struct Dead {
    Process* process;
    SteadyTime until;
  };
  std::vector<Dead> dead;
  while (steady_now() < end) {
    std::this_thread::sleep_for(milliseconds(50 + random() % 500));
    for (const Process& server : robot.servers)
      counts.max_resident_bytes = std::max(counts.max_resident_bytes, server.resident_bytes());
    const auto is_due = [](const Dead& one) {
      if (steady_now() < one.until) return false;
      one.process->start();
      return true;
    };
    std::erase_if(dead, is_due);
    for (Process* process : robot.all())
      if (process->has_ended()) {
        ++counts.ended_by_themselves;
        fmt::print("{} ended by itself\n", fmt::join(process->words(), " "));
        process->start();
      }
    const uint32_t kind = random() % 10;
    auto& some = kind < 4 ? robot.servers : kind < 9 ? robot.clients : robot.names;
    Process& victim = some[random() % some.size()];
    if (std::ranges::any_of(dead, [&](const Dead& one) { return one.process == &victim; }))
      continue;
    victim.kill();
    ++counts.killed[victim.words()[0]];
    dead.push_back({&victim, steady_now() + milliseconds(random() % 1500)});
  }
  for (const Dead& one : dead) one.process->start();
}

/// Looks for everything that was acknowledged.
Status check_store(const std::filesystem::path& folder, const std::string& memory, Counts& counts) {
  ENGRAM_ASSIGN_OR_RETURN(const auto store, ltm::StoreReader::open(store_path(folder, memory)));
  for (int writer = 0; writer < kWriters; ++writer) {
    ENGRAM_ASSIGN_OR_RETURN(const auto entity, ltm::MemoryId::parse(entity_name(memory, writer)));
    const auto numbers = Ledger::read(ledger_path(folder, memory, writer));
    if (numbers.empty()) continue;
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, store->timeline(entity));
    for (const int64_t number : numbers) {
      ++counts.acknowledged;
      ENGRAM_ASSIGN_OR_RETURN(const auto found, timeline->at_or_after(time_from_ns(number)));
      if (found && to_ns(found->time) == number) continue;
      ++counts.lost;
      fmt::print("lost: {} at {}\n", entity.to_string(), number);
    }
  }
  return {};
}

void print(const Counts& counts) {
  std::string killed;
  for (const auto& [role, count] : counts.killed) killed += fmt::format(" {} {}", count, role);
  const auto read = [&counts](int64_t what) {
    const auto found = counts.read.find(what);
    return found == counts.read.end() ? uint64_t{0} : found->second;
  };
  fmt::print("killed:{}; ended by themselves: {}; ended badly: {}\n", killed,
             counts.ended_by_themselves, counts.ended_badly);
  fmt::print("commits acknowledged as durable: {}; lost: {}\n", counts.acknowledged, counts.lost);
  fmt::print("answers: {}; failed: {}; told: {}; interrupted: {}; wrong: {}\n", read(kAnswers),
             read(kFailed), read(kTold), read(kInterrupted), read(kWrong));
  fmt::print("most RAM of a server: {} MiB\n", counts.max_resident_bytes >> 20);
}

int soak(int seconds, uint32_t seed) {
  const auto shared_before = shared_memory();
  const ScratchDirectory folder;
  std::mt19937 random(seed);
  Counts counts;
  {
    Robot robot(folder.path());
    for (Process* process : robot.all()) process->start();
    make_trouble(robot, std::chrono::seconds(seconds), random, counts);
    for (auto* some : {&robot.clients, &robot.servers, &robot.names})
      for (Process& process : *some)
        if (!process.end()) {
          ++counts.ended_badly;
          fmt::print("{} did not end in order\n", fmt::join(process.words(), " "));
        }
  }
  for (int i = 0; i < kServers; ++i)
    if (const Status status = check_store(folder.path(), memory_name(i), counts); !status.ok()) {
      fmt::print("store of {}: {}\n", memory_name(i), status.to_string());
      ++counts.lost;
    }
  for (int i = 0; i < kReaders; ++i)
    for (const int64_t what : Ledger::read(reader_path(folder.path(), i))) ++counts.read[what];
  print(counts);
  const bool is_clean = shared_memory() == shared_before;
  if (!is_clean) fmt::print("something is left in /dev/shm\n");
  const bool is_fine = counts.lost == 0 && counts.acknowledged > 0 && counts.read[kWrong] == 0 &&
                       counts.read[kAnswers] > 0 && counts.read[kTold] > 0 &&
                       counts.ended_by_themselves == 0 && counts.ended_badly == 0 && is_clean &&
                       counts.max_resident_bytes < kMaxResidentBytes;
  fmt::print("{}\n", is_fine ? "fine" : "NOT FINE");
  return is_fine ? 0 : 1;
}

int run(const std::vector<std::string>& words) {
  const auto role = [&]() -> Status {
    if (words[0] == "names") return run_names(words[1]);
    if (words[0] == "memory") return run_memory(words[1], words[2], std::stoi(words[3]));
    if (words[0] == "writer") return run_writer(words[1], std::stoi(words[2]));
    return run_reader(words[1], std::stoi(words[2]));
  };
  if (words.size() >= 3) {
    const Status status = role();
    if (!status.ok()) fmt::print(stderr, "{}: {}\n", words[0], status.to_string());
    return status.ok() ? 0 : 1;
  }
  if (words.empty()) {
    fmt::print(stderr, "usage: soak_server SECONDS [SEED]\n");
    return 2;
  }
  return soak(std::stoi(words[0]),
              words.size() > 1 ? static_cast<uint32_t>(std::stoul(words[1])) : 1);
}

}  // namespace
}  // namespace engram::soak

int main(int count, char** words) {
  return engram::soak::run({words + 1, words + count});
}
